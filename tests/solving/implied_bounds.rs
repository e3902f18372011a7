//! Variables that only rows bound: the answer is that of the same model with the bounds given, and
//! that of enumeration.

use carom::model::{Method, Reformulation, sos1, sos2};
use carom::prelude::*;
use proptest::prelude::*;
use proptest::sample::select;

use crate::common::case::{Case, Line};
use crate::common::config;
use crate::common::enumeration::optimum;
use crate::common::generate::{Shape, case};
use crate::common::quadratic_program::Minimum;

const INF: f64 = f64::INFINITY;

/// The case without bounds of its continuous and integer columns, which rows imply instead.
fn without_bounds(case: &Case, ways: &[u8]) -> Case {
    let mut open = case.clone();
    let n = case.columns.len();
    for (j, way) in (0..n).zip(ways.iter().cycle()) {
        let column = &mut open.columns[j];
        if column.kind == VariableKind::Binary || column.lower > column.upper {
            continue;
        }
        let (lower, upper) = (column.lower, column.upper);
        (column.lower, column.upper) = (-INF, INF);
        let mut line = |a: f64, of: Option<usize>, lower: f64, upper: f64| {
            let mut coefficients = vec![0.0; n];
            coefficients[j] = a;
            of.into_iter().for_each(|k| coefficients[k] = -a);
            open.lines.push(Line { coefficients, lower, upper, scale: 1.0 });
        };
        match way % 3 {
            0 => line(1.0, None, lower, upper),
            1 => line(-2.0, None, -2.0 * upper, -2.0 * lower),
            _ => {
                line(0.5, None, 0.5 * lower, INF);
                line(-1.0, None, -upper, INF);
            }
        }
    }
    open
}

/// One more statement of each kind over the variables of a model.
fn add_statements(
    model: &mut Model,
    x: &[Variable],
    (kinds, limits): (u8, [f64; 3]),
    method: Method,
) {
    let [a, b, c] = limits;
    let at = |k: usize| x[k];
    if kinds & 1 > 0 {
        model.add("way", either([at(0).le(a), at(1).ge(b)]).or((at(0) + at(2)).ge(c))).unwrap();
    }
    if kinds & 2 > 0 {
        let far = model.absolute("far", at(1) - at(2) - a).unwrap();
        model.add("not_near", Affine::from(far).ge(b.abs())).unwrap();
    }
    if kinds & 4 > 0 {
        model.add("set", sos1([(at(0), 1.0), (at(1), 2.0), (at(2), 3.0)])).unwrap();
    }
    if kinds & 8 > 0 {
        model.add("pair", sos2([(at(2), 1.0), (at(1), 2.0), (at(0), 3.0)])).unwrap();
    }
    if kinds & 16 > 0 {
        let top = model.maximum("top", [Affine::from(at(0)), at(1) + c]).unwrap();
        model.add("enough", (top - at(2)).ge(b)).unwrap();
    }
    if kinds & 32 > 0 {
        let on = model.binary("on").unwrap();
        let part = model.product("part", on, at(0) + at(1)).unwrap();
        model.add("partly", (part + at(2)).ge(a)).unwrap();
    }
    if kinds & 64 > 0 {
        let on = model.binary("held").unwrap();
        model.add("hold", on.on().implies((at(0) - at(1)).within(-1.0, 1.0))).unwrap();
        model.add("drop", on.off().implies((at(0) + at(1)).ge(c))).unwrap();
    }
    model.set_reformulation(Reformulation::default().with_method(method));
}

proptest! {
    #![proptest_config(config(150, "tests/regressions/implied_bounds.txt"))]

    #[test]
    fn enumeration_agrees(case in case(Shape::BOUNDED), ways in prop::array::uniform8(0u8..3), programs in any::<bool>()) {
        let (mut model, _) = without_bounds(&case, &ways).build();
        model.set_reformulation(Reformulation::default().with_linear_programs(programs));
        let solution = BranchAndBound::default().solve(&model).unwrap();
        match optimum(&case) {
            Minimum::Attained { value, .. } => {
                prop_assert!(solution.is_optimal(), "{solution:?}");
                let found = case.sign() * solution.objective().unwrap();
                prop_assert!((found - value).abs() < 1e-5 * value.abs().max(1.0), "{found} {value}");
            }
            _ => prop_assert!(solution.is_infeasible(), "{solution:?}"),
        }
    }

    /// Networks in which flow may circulate, with indicators that limit sums of flows: the answer
    /// is that of the network with capacities that no plan needs.
    #[test]
    fn circulations_are_not_needed(
        arcs in prop::collection::vec((0usize..5, 0usize..5, 0i32..3), 3..10),
        supplies in prop::array::uniform4(-3i32..=3),
        limits in prop::collection::vec((prop::collection::vec(0usize..10, 1..4), 0i32..4), 1..4),
        slack in prop::array::uniform4(0i32..2),
    ) {
        let arcs: Vec<_> = arcs.into_iter().filter(|(from, to, _)| from != to).collect();
        prop_assume!(!arcs.is_empty());
        let mut answers = Vec::new();
        for capacity in [INF, 40.0] {
            let mut model = Model::new("flow");
            let x = model.continuous_family("x", arcs.len(), 0.0, capacity).unwrap();
            // Node 4 is outside: nothing balances it.
            for (node, &supply) in supplies.iter().enumerate() {
                let mut sum = Affine::zero();
                for (k, &(from, to, _)) in arcs.iter().enumerate() {
                    sum += if to == node { x[k].into() } else { Affine::zero() };
                    sum -= if from == node { x[k].into() } else { Affine::zero() };
                }
                if !sum.terms().is_empty() {
                    let supply = f64::from(supply);
                    let row = sum.within(supply, supply + f64::from(slack[node]));
                    model.add(("node", node), row).unwrap();
                }
            }
            let mut cost: Affine = arcs.iter().enumerate().map(|(k, a)| f64::from(a.2) * x[k]).sum();
            for (k, (of, most)) in limits.iter().enumerate() {
                let over = model.binary(("over", k)).unwrap();
                let sum: Affine = of.iter().map(|&v| Affine::from(x[v % arcs.len()])).sum();
                let row = sum.le(f64::from(*most));
                model.add(("limit", k), over.off().implies(row)).unwrap();
                cost += 1.5 * over;
            }
            model.minimize(cost).unwrap();
            let solution = BranchAndBound::default().solve(&model).unwrap();
            prop_assert!(solution.is_optimal() || solution.is_infeasible(), "{solution:?}");
            answers.push(solution.objective());
        }
        match (answers[0], answers[1]) {
            (Some(a), Some(b)) => prop_assert!((a - b).abs() < 1e-5 * b.abs().max(1.0), "{a} {b}"),
            (None, None) => {}
            _ => prop_assert!(false, "{answers:?}"),
        }
    }

    #[test]
    fn given_bounds_agree(
        case in case(Shape::BOUNDED),
        ways in prop::array::uniform8(0u8..3),
        kinds in 1u8..128,
        limits in prop::array::uniform3(-3i32..=3),
        method in select(Method::ALL.to_vec()),
    ) {
        prop_assume!(case.columns.len() >= 3);
        let limits = limits.map(f64::from);
        let mut answers = Vec::new();
        for case in [without_bounds(&case, &ways), case] {
            let (mut model, variables) = case.build();
            add_statements(&mut model, &variables, (kinds, limits), method);
            let solution = BranchAndBound::default().solve(&model).unwrap();
            prop_assert!(solution.is_optimal() || solution.is_infeasible(), "{solution:?}");
            answers.push(solution.objective());
        }
        match (answers[0], answers[1]) {
            (Some(a), Some(b)) => prop_assert!((a - b).abs() < 1e-5 * b.abs().max(1.0), "{a} {b}"),
            (None, None) => {}
            _ => prop_assert!(false, "{answers:?}"),
        }
    }
}
