//! General constraints: what is read, what is refused, and their optima against enumeration.

use carom::model::lp;
use carom::prelude::*;
use proptest::prelude::*;

use super::{error, warned};
use crate::common::config;

fn text(constraints: &str) -> String {
    format!(
        "min w + x\nst\n c: x + y >= 1\nbounds\n -5 <= x <= 5\n y <= 3\n w free\nGeneral Constraints\n{constraints}\nend\n"
    )
}

#[test]
fn functions_define_their_results() {
    let says = |constraints: &str, part: &str| {
        let (warnings, model) = warned(&text(constraints));
        assert_eq!(warnings, [""; 0], "{model}");
        assert!(model.contains(part), "{model}");
    };
    says(" g: w = MAX ( x , y , 3 )", "w = max(x, y, 3)");
    says(" w = max(x,y,-2.5)", "w = max(x, y, -2.5)");
    says(" g: w = MIN ( x , y )", "w = min(x, y)");
    says(" g: w = ABS ( x )", "w = |x|");
    says(" g: w = NORM ( INF ) ( x , y )", "w = max(-x, x, -y, y)");
    says(" g: w = NORM ( 1 ) ( x , y )", "g: w - g_x - g_y = 0");
    says(
        " g*1: w = PWL ( x ) : ( -5 , 1 ) ( 0 , 0 ) ( 5 , 2 )",
        "w = f(x) through (-5, 1) (0, 0) (5, 2)",
    );
    says(" g: w = PWL ( x ) : (0, 0) (1, 2)", "through (-5, -10) (5, 10)");
    // A variable is one function; the second is a row.
    says(" a: w = MAX ( x , y )\n b: w = MIN ( x , 2 )", "b: w - b = 0");
    // So is a function of itself.
    says(" g: w = MAX ( w , y )", "g: w - g = 0");
    let logic = "min r\nst\n c: a + b >= 1\nbinary\n a b r\nGeneral Constraints\n g: r = AND ( a , b )\n \
                 h: r = OR ( a , b )\nend";
    let (_, model) = warned(logic);
    assert!(model.contains("g: r iff (a & b)") && model.contains("h: r iff (a | b)"), "{model}");
}

#[test]
fn the_result_has_its_bounds() {
    let solve = |text: &str| {
        let read = lp::read(text).expect("a model");
        assert!(read.warnings.is_empty());
        BranchAndBound::default().solve(&read.model).expect("a solve")
    };
    let shrunk = "Minimize\n  2 w + y\nSubject To\n c1: x + y >= 3\n c2: x - y >= -1\nBounds\n \
                  -10 <= x <= 10\n y <= 4\n w free\nGeneral Constraints\n g1: w = MAX ( x , 0 )\nEnd\n";
    assert!((solve(shrunk).objective().expect("a point") - 4.0).abs() < 1e-6);
    // A result is at least 0 unless its bounds say otherwise.
    let least = "max x\nst\n c: x + y <= 4\nbounds\n -9 <= x <= 9\n -1 <= y <= 1\nGeneral Constraints\n \
                 g: w = MIN ( y , 7 )\nend";
    assert!((solve(least).objective().expect("a point") - 4.0).abs() < 1e-6);
}

#[test]
fn damaged_functions_are_named() {
    let cases = [
        (" g: w = MAX", "line 10, column 1: expected `(`, found `end`"),
        (" g: w = MAX ( x y )", "line 9, column 17: expected `,` or `)`, found `y`"),
        (" g: w = MAX ( x ,", "line 10, column 1: expected a finite number or a name, found `end`"),
        (
            " g: w = MAX ( inf )",
            "line 9, column 15: expected a finite number or a name, found `inf`",
        ),
        (
            " g: w MAX ( x )",
            "line 9, column 7: expected `=` and a function, such as `MAX ( x , y , 3 )`, found `MAX`",
        ),
        (
            " g: w = SUM ( x )",
            "line 9, column 9: expected `MAX`, `MIN`, `ABS`, `AND`, `OR`, `NORM` or `PWL`, found `SUM`",
        ),
        (
            " g: w = EXP ( x )",
            "line 9, column 9: `EXP` cannot be read: it is not piecewise affine; write it as `PWL ( x ) : ( x1 , y1 ) \
             ( x2 , y2 ) ...` with points close enough for you",
        ),
        (
            " g: w = NORM ( 2 ) ( x , y )",
            "line 9, column 16: that a variable equals a Euclidean norm is not convex; write a quadratic row, such as \
             `[ x ^2 + y ^2 - r ^2 ] <= 0`, which bounds the norm by the variable",
        ),
        (
            " g: w = NORM ( 3 ) ( x )",
            "line 9, column 16: expected the order 1, 2 or INF of a norm, found `3`",
        ),
        (" g: w = ABS ( x , y )", "line 9, column 9: `ABS` is a function of one variable alone"),
        (" g: w = OR ( 1 , y )", "line 9, column 9: `OR` is a function of variables alone"),
        (
            " g: w = AND ( x , y )",
            "line 9, column 2: `x` stands in `AND` or `OR` and is not listed under `Binary`",
        ),
        (
            " g: w = PWL ( x )",
            "line 10, column 1: expected `:` and points, such as `: ( 0 , 0 ) ( 1 , 2 )`, found `end`",
        ),
        (
            " g: w = PWL ( w2 ) : ( 0 , 0 ) ( 1 , 2 )",
            "line 9, column 2: the function goes on behind its points, so `w2` needs finite bounds; give them",
        ),
    ];
    for (constraints, message) in cases {
        assert_eq!(error(&text(constraints)), message, "{constraints}");
    }
    let jump = error(&text(" g: w = PWL ( x ) : ( 0 , 0 ) ( 0 , 2 )"));
    assert!(jump.starts_with("line 9, column 2: "), "{jump}");
    assert_eq!(
        error("min x\nst\n c: x >= 1\nPWLObj\n x: (0, 0) (1, 2)\nend"),
        "line 4, column 1: section `PWLObj` cannot be read: write each function under `General Constraints`, as \
         `y = PWL ( x ) : ( 0 , 0 ) ( 1 , 2 )`, and `y` in the objective"
    );
}

/// A function of three integers, and costs of all.
#[derive(Debug, Clone)]
struct Functions {
    kind: usize,
    number: i32,
    points: Vec<(i32, i32)>,
    costs: [i32; 5],
    limits: (i32, i32),
    maximize: bool,
    least: Option<i32>,
    is_whole: bool,
}

const RANGE: i32 = 3;

impl Functions {
    fn value(&self, [x, y, z]: [i32; 3]) -> f64 {
        let whole = |value: i32| f64::from(value);
        match self.kind {
            0 => whole(x.max(y).max(self.number)),
            1 => whole(x.min(y).min(z)),
            2 => whole(x.abs()),
            3 => whole(x.abs() + y.abs()),
            4 => whole(x.abs().max(y.abs()).max(z.abs())),
            _ => {
                let n = self.points.len();
                let right =
                    self.points.iter().position(|p| p.0 > x).unwrap_or(n - 1).clamp(1, n - 1);
                let ((x0, y0), (x1, y1)) = (self.points[right - 1], self.points[right]);
                whole(y0) + whole(y1 - y0) / whole(x1 - x0) * whole(x - x0)
            }
        }
    }

    fn text(&self) -> String {
        let Functions { costs: [a, b, c, d, e], number, .. } = self;
        let points: Vec<String> =
            self.points.iter().map(|(x, y)| format!("( {x} , {y} )")).collect();
        let function = match self.kind {
            0 => format!("MAX ( x , y , {number} )"),
            1 => "MIN ( x , y , z )".to_owned(),
            2 => "ABS ( x )".to_owned(),
            3 => "NORM ( 1 ) ( x , y )".to_owned(),
            4 => "NORM ( INF ) ( x , y , z )".to_owned(),
            _ => format!("PWL ( x ) : {}", points.join(" ")),
        };
        let sense = if self.maximize { "max" } else { "min" };
        let sign =
            |value: i32| if value < 0 { format!("- {}", -value) } else { format!("+ {value}") };
        let bound = self.least.map_or("w free".to_owned(), |least| format!("w >= {least}"));
        let whole = if self.is_whole { " w" } else { "" };
        let Functions { limits: (least, most), .. } = self;
        format!(
            "{sense} {a} x {} y {} z {} w {} v\nst\n r: {least} <= x + y + z + w <= {most}\nbounds\n -{RANGE} <= x <= {RANGE}\n \
             -{RANGE} <= y <= {RANGE}\n -{RANGE} <= z <= {RANGE}\n {bound}\n v free\ngenerals\n x y z{whole}\n\
             General Constraints\n f: w = {function}\n g: v = MAX ( w , z , -1 )\nend\n",
            sign(*b),
            sign(*c),
            sign(*d),
            sign(*e)
        )
    }

    fn optimum(&self) -> Option<f64> {
        let mut best: Option<f64> = None;
        let side = || -RANGE..=RANGE;
        for (x, y, z) in
            side().flat_map(|x| side().flat_map(move |y| side().map(move |z| (x, y, z))))
        {
            let w = self.value([x, y, z]);
            let sum = f64::from(x + y + z) + w;
            let (least, most) = self.limits;
            let is_out = sum < f64::from(least) - 1e-9 || sum > f64::from(most) + 1e-9;
            let is_broken = self.is_whole && (w - w.round()).abs() > 1e-9;
            if is_out || is_broken || self.least.is_some_and(|least| w < f64::from(least) - 1e-9) {
                continue;
            }
            let v = w.max(f64::from(z)).max(-1.0);
            let [a, b, c, d, e] = self.costs.map(f64::from);
            let cost = a * f64::from(x) + b * f64::from(y) + c * f64::from(z) + d * w + e * v;
            let is_better =
                best.is_none_or(|best| if self.maximize { cost > best } else { cost < best });
            best = if is_better { Some(cost) } else { best };
        }
        best
    }
}

prop_compose! {
    fn functions()(
        kind in 0_usize..6,
        number in -3..4,
        steps in prop::collection::vec((1..3, -4..5), 2..5),
        costs in prop::array::uniform5(-4..5),
        limits in (-6..2, 2..8),
        maximize in any::<bool>(),
        least in prop::option::of(-3..3),
        is_whole in any::<bool>(),
    ) -> Functions {
        let mut at = -4;
        let points = steps.into_iter().map(|(step, y)| { at += step; (at, y) }).collect();
        Functions { kind, number, points, costs, limits, maximize, least, is_whole }
    }
}

proptest! {
    #![proptest_config(config(200, "tests/regressions/lp_functions.txt"))]

    #[test]
    fn functions_have_the_optimum_of_enumeration(case in functions()) {
        let text = case.text();
        let read = lp::read(&text).expect("a model");
        let solution = BranchAndBound::default().solve(&read.model).expect("a solve");
        match case.optimum() {
            None => prop_assert!(solution.is_infeasible(), "{:?}\n{text}", solution.termination()),
            Some(best) => {
                prop_assert!(solution.is_optimal(), "{:?}\n{text}", solution.termination());
                let found = solution.objective().expect("a point");
                prop_assert!((found - best).abs() <= 1e-4 * best.abs().max(1.0), "{found} {best}\n{text}");
            }
        }
    }
}
