//! Random models there and back, and random damage.

use carom::model::mps;
use carom::prelude::*;
use proptest::prelude::*;

use crate::{assert_same, read, with};

/// A number a model can hold: round decimals, any bits, and the awkward ones.
fn number() -> impl Strategy<Value = f64> {
    prop_oneof![
        4 => (-400_i32..400).prop_map(|n| f64::from(n) / 10.0),
        2 => any::<f64>().prop_filter("finite", |v| v.abs() < 1e20),
        2 => -3.0..3.0_f64,
        1 => prop::sample::select(vec![0.0, -0.0, 1.0, -1.0, 5e-324, -9.9e19, 1e-300, 1e16, 0.1]),
    ]
}

/// Two numbers in order, either possibly infinite but not both unless allowed.
fn pair(both_infinite: bool) -> impl Strategy<Value = (f64, f64)> {
    let open = if both_infinite { 1 } else { 0 };
    prop_oneof![
        6 => (number(), number()).prop_map(|(a, b)| if a <= b { (a, b) } else { (b, a) }),
        2 => number().prop_map(|a| (a, a)),
        2 => number().prop_map(|a| (a, f64::INFINITY)),
        2 => number().prop_map(|a| (f64::NEG_INFINITY, a)),
        open => Just((f64::NEG_INFINITY, f64::INFINITY)),
    ]
}

fn name() -> impl Strategy<Value = String> {
    prop_oneof![
        3 => "[a-zA-Z_][a-zA-Z0-9_.]{0,6}",
        2 => "[a-z]\\[[0-9]{1,3}\\]",
        1 => prop::sample::select(vec![
            "RHS", "BOUND", "RANGE", "obj", "obj_", "'MARKER'", "'INTORG'", "*", "$", "1", "-1e5",
            "IF", "MAX", "ENDATA", "NAME", "höhe", "UP", "FR", "MARKER0",
        ]).prop_map(str::to_owned),
    ]
}

/// Name, terms, limits, condition.
type RowPlan = (String, Vec<(usize, f64)>, (f64, f64), Option<(usize, bool)>);

#[derive(Debug, Clone)]
struct Plan {
    name: String,
    maximize: bool,
    constant: f64,
    variables: Vec<(String, u8, (f64, f64), f64)>,
    rows: Vec<RowPlan>,
    squares: Vec<(f64, usize, f64, usize)>,
}

fn plan() -> impl Strategy<Value = Plan> {
    let variable = (name(), 0..4_u8, pair(true), number());
    let terms = prop::collection::vec((0..8_usize, number()), 1..5);
    let row = (name(), terms, pair(false), prop::option::of((0..8_usize, any::<bool>())));
    let square = (-9.0..9.0_f64, 0..8_usize, -9.0..9.0_f64, 0..8_usize);
    (
        "[a-z ]{0,8}",
        any::<bool>(),
        number(),
        prop::collection::vec(variable, 1..8),
        prop::collection::vec(row, 0..8),
        prop::collection::vec(square, 0..4),
    )
        .prop_map(|(name, maximize, constant, variables, rows, squares)| Plan {
            name: name.trim().to_owned(),
            maximize,
            constant,
            variables,
            rows,
            squares,
        })
}

/// Builds what a plan says; statements that a model refuses (names taken, empty rows) are left
/// out.
fn build(plan: &Plan) -> Model {
    let mut model = Model::new(plan.name.clone());
    let mut variables = Vec::new();
    for (name, kind, (lower, upper), _) in &plan.variables {
        let added = match kind {
            0 => model.binary(name),
            // Bounds within [0, 1] would make it a binary on reading.
            1 if *lower >= 0.0 && *upper <= 1.0 => {
                model.variable(name.as_str(), VariableKind::Binary, *lower, *upper)
            }
            1 => model.integer(name, *lower, *upper),
            _ => model.continuous(name, *lower, *upper),
        };
        variables.extend(added);
    }
    if variables.is_empty() {
        return model;
    }
    let pick = |k: usize| variables[k % variables.len()];
    for (name, terms, (lower, upper), condition) in &plan.rows {
        let mut expression = Affine::zero();
        terms.iter().for_each(|&(k, a)| expression.add_term(a, pick(k)));
        let row = expression.within(*lower, *upper);
        let refused = match *condition {
            Some((k, true)) => model.add(name, pick(k).on().implies(row)).err(),
            Some((k, false)) => model.add(name, pick(k).off().implies(row)).err(),
            None => model.add(name, row).err(),
        };
        drop(refused);
    }
    let mut objective = Quadratic::from(plan.constant);
    for (variable, (.., cost)) in variables.iter().zip(&plan.variables) {
        objective += *cost * *variable;
    }
    let sign = if plan.maximize { -1.0 } else { 1.0 };
    for &(a, i, b, j) in &plan.squares {
        objective += (a * pick(i) + b * pick(j)).square() * sign;
    }
    let sense = if plan.maximize { Sense::Maximize } else { Sense::Minimize };
    model.set_objective(sense, objective).unwrap();
    model
}

/// Files to damage: one written by hand with every section, one written by the crate.
fn whole_files() -> Vec<String> {
    let mut model = Model::new("whole");
    let x = model.continuous_family("x", 3, -1.0, 4.5).unwrap();
    let z = model.binary("z").unwrap();
    model.add("sum", (x[0] + x[1] + 0.5 * x[2]).within(-1.2, 1.1)).unwrap();
    model.add("hit", z.on().implies(x[1].le(0.0))).unwrap();
    model.minimize((x[0] - x[1]).square() + 3.0 * x[2] + 1.0).unwrap();
    let by_hand = with(
        "RHS\n B most 4 least -1e2\n B cost 2\nRANGES\n R most 3 least Infinity\nBOUNDS\n \
         UP B x 4\n MI B y\n BV B k\nQMATRIX\n x x 2\n x y 1D0\n y x 1\n y y 2\nINDICATORS\n \
         IF most k 1\n",
    );
    vec![by_hand, mps::write(&model).unwrap()]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(512))]

    #[test]
    fn round_trips_are_exact(plan in plan()) {
        let model = build(&plan);
        let text = mps::write(&model).unwrap();
        let again = mps::read(&text).unwrap_or_else(|error| panic!("{error}\n{text}"));
        assert_same(&model, &again);
        prop_assert_eq!(mps::write(&again).unwrap(), text);
    }

    #[test]
    fn two_sided_rows_are_exact((lower, upper) in pair(false)) {
        let mut model = Model::new("");
        let x = model.continuous("x", 0.0, 1.0).unwrap();
        model.add("r", x.within(lower, upper)).unwrap();
        assert_same(&model, &read(&mps::write(&model).unwrap()));
    }

    #[test]
    fn cut_off_files_are_refused(which in 0..2_usize, share in 0.0..1.0_f64) {
        let text = &whole_files()[which];
        let whole = text.len() - "ENDATA\n".len();
        let mut end = (share * whole as f64) as usize;
        while !text.is_char_boundary(end) {
            end -= 1;
        }
        let refused = matches!(mps::read(&text[..end]), Err(Error::Parse { .. }));
        prop_assert!(refused, "{}", &text[..end]);
    }

    #[test]
    fn damage_never_panics(
        which in 0..2_usize,
        edits in prop::collection::vec((any::<prop::sample::Index>(), 0..4_u8, any::<char>()), 1..6),
        words in prop::collection::vec(
            prop::sample::select(vec!["1e400", "-", "1e-999999999", "nan", "'MARKER'", "x", "UP"]),
            6,
        ),
    ) {
        let mut text: Vec<char> = whole_files()[which].chars().collect();
        for ((place, edit, letter), word) in edits.into_iter().zip(words) {
            let place = place.index(text.len());
            match edit {
                0 => { text.remove(place); }
                1 => text[place] = letter,
                2 => text.insert(place, '\n'),
                _ => { text.splice(place..place, word.chars()); }
            }
        }
        let text: String = text.into_iter().collect();
        if let Ok(model) = mps::read(&text) {
            let again = read(&mps::write(&model).unwrap());
            prop_assert_eq!(model.to_string(), again.to_string());
        }
    }
}
