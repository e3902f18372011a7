//! Random small models against enumeration: every set named contradicts itself, and without any
//! one of its families there is a solution.

use carom::explain::{
    ElasticOptions, ExplainOptions, ExplanationStatus, elastic_relaxation, infeasibility,
    violations,
};
use carom::prelude::*;
use proptest::prelude::*;

use crate::common;

const BINARIES: usize = 4;

/// One statement over the binaries, with a family and a step.
#[derive(Debug, Clone)]
enum Said {
    Row { terms: Vec<i32>, most: i32 },
    Implied { on: usize, terms: Vec<i32>, most: i32 },
    Clause { literals: Vec<(usize, bool)> },
}

fn statement() -> impl Strategy<Value = Said> {
    let terms = || prop::collection::vec(-2..=2i32, BINARIES);
    let literal = (0..BINARIES, any::<bool>());
    prop_oneof![
        (terms(), -2..=2i32).prop_map(|(terms, most)| Said::Row { terms, most }),
        (0..BINARIES, terms(), -2..=2i32).prop_map(|(on, terms, most)| Said::Implied {
            on,
            terms,
            most
        }),
        prop::collection::vec(literal, 1..3).prop_map(|literals| Said::Clause { literals }),
    ]
}

impl Said {
    /// Whether it holds at a point given by bits.
    fn holds(&self, bits: u32) -> bool {
        let on = |k: usize| bits >> k & 1 == 1;
        let sum = |terms: &[i32]| -> i32 {
            terms.iter().enumerate().filter(|&(k, _)| on(k)).map(|(_, a)| a).sum()
        };
        match self {
            Said::Row { terms, most } => sum(terms) <= *most,
            Said::Implied { on: z, terms, most } => !on(*z) || sum(terms) <= *most,
            Said::Clause { literals } => literals.iter().any(|&(k, value)| on(k) == value),
        }
    }

    /// By how much it fails at a point given by bits.
    fn amount(&self, bits: u32) -> f64 {
        let on = |k: usize| bits >> k & 1 == 1;
        let excess = |terms: &[i32], most: i32| {
            let ones = terms.iter().enumerate().filter(|&(k, _)| on(k));
            f64::from((ones.map(|(_, a)| a).sum::<i32>() - most).max(0))
        };
        match self {
            _ if self.holds(bits) => 0.0,
            Said::Row { terms, most } | Said::Implied { terms, most, .. } => excess(terms, *most),
            Said::Clause { .. } => 1.0,
        }
    }

    /// `false` where the model refuses to hold it: a row without variables.
    fn add(&self, model: &mut Model, z: &[Variable], name: (String, usize)) -> bool {
        let sum = |terms: &[i32]| -> Affine {
            terms.iter().zip(z).map(|(&a, &z)| f64::from(a) * z).sum()
        };
        match self {
            Said::Row { terms, most } => model.add(name, sum(terms).le(f64::from(*most))).is_ok(),
            Said::Implied { on, terms, most } => {
                model.add(name, z[*on].on().implies(sum(terms).le(f64::from(*most)))).is_ok()
            }
            Said::Clause { literals } => {
                let literals =
                    literals.iter().map(|&(k, on)| if on { z[k].on() } else { z[k].off() });
                model.add(name, Logic::any(literals)).is_ok()
            }
        }
    }
}

proptest! {
    #![proptest_config(common::config(120, "tests/regressions/explain.txt"))]

    #[test]
    fn sets_are_contradictory_and_irreducible(
        said in prop::collection::vec((0..6usize, statement()), 3..14),
        narrowing in prop_oneof![Just(0usize), Just(20)],
        background in any::<bool>(),
    ) {
        let mut model = Model::new("random");
        let z: Vec<Variable> = model.binary_family("z", BINARIES).unwrap().iter().collect();
        let mut kept: Vec<(String, String, &Said)> = Vec::new();
        for (step, (family, said)) in said.iter().enumerate() {
            let family = format!("f{family}");
            if said.add(&mut model, &z, (family.clone(), step)) {
                kept.push((family.clone(), format!("{family}[{step}]"), said));
            }
        }
        let quiet = background && kept.iter().any(|(family, ..)| family == "f0");
        if quiet {
            model.set_background("f0").unwrap();
        }
        let possible = |keep: &dyn Fn(&str, &str) -> bool| {
            (0..1u32 << BINARIES).any(|bits| {
                kept.iter().all(|(family, name, said)| {
                    !(quiet && family == "f0" || keep(family, name)) || said.holds(bits)
                })
            })
        };
        let options = ExplainOptions::default().with_narrowing(narrowing);
        let why = infeasibility(&model, &options, &mut BranchAndBound::default()).unwrap();
        if possible(&|_, _| true) {
            prop_assert_eq!(why.status(), ExplanationStatus::Feasible);
            let point = why.point().unwrap().as_slice();
            prop_assert_eq!(violations(&model, point, 1e-6).unwrap().len(), 0);
            return Ok(());
        }
        prop_assert_eq!(why.status(), ExplanationStatus::Irreducible);
        let named: Vec<String> =
            why.groups().iter().flat_map(|g| g.statements()).map(Name::to_string).collect();
        prop_assert!(!possible(&|_, name| named.iter().any(|n| n == name)), "{} is possible", why);
        for group in why.groups() {
            prop_assert!(
                possible(&|family, _| family != group.name()
                    && why.groups().iter().any(|g| g.name() == family)),
                "{} is not needed in {}", group, why
            );
            // The point that is returned satisfies all other families named, in full.
            let point = group.without().unwrap();
            for violation in violations(&model, point.as_slice(), 1e-6).unwrap() {
                let family = Name::from(violation.name.as_str()).family().to_owned();
                let other = why.groups().iter().any(|g| g.name() == family && g != group);
                prop_assert!(!(other || quiet && family == "f0"));
            }
        }
    }

    /// The least cost of giving way, against enumeration.
    #[test]
    fn elastic_costs_are_the_least(
        said in prop::collection::vec((0..4usize, statement()), 3..10),
        weights in prop::collection::vec(1..5i32, 4),
        quiet in any::<bool>(),
    ) {
        let mut model = Model::new("random");
        let z: Vec<Variable> = model.binary_family("z", BINARIES).unwrap().iter().collect();
        let mut kept: Vec<(usize, &Said)> = Vec::new();
        for (step, (family, said)) in said.iter().enumerate() {
            if said.add(&mut model, &z, (format!("f{family}"), step)) {
                kept.push((*family, said));
            }
        }
        let mut options = ElasticOptions::default();
        for (family, weight) in weights.iter().enumerate() {
            if kept.iter().any(|(f, _)| *f == family) {
                let weight = if quiet && family == 0 { f64::INFINITY } else { f64::from(*weight) };
                options = options.with_weight(format!("f{family}"), weight);
            }
        }
        let cost = |bits: u32| -> f64 {
            let cost = |&(family, said): &(usize, &Said)| match said.amount(bits) {
                0.0 => 0.0,
                _ if quiet && family == 0 => f64::INFINITY,
                amount => amount * f64::from(weights[family]),
            };
            kept.iter().map(cost).sum()
        };
        let least = (0..1u32 << BINARIES).map(cost).fold(f64::INFINITY, f64::min);
        let relaxed = elastic_relaxation(&model, &options, &mut BranchAndBound::default()).unwrap();
        if least.is_infinite() {
            prop_assert_eq!(relaxed.termination(), Termination::Infeasible);
            return Ok(());
        }
        prop_assert!(relaxed.is_optimal());
        prop_assert!((relaxed.cost().unwrap() - least).abs() < 1e-5, "{} for {}", relaxed, least);
        // What is reported is what the point violates.
        let point = relaxed.point().unwrap();
        let found = violations(&model, point.as_slice(), 1e-6).unwrap();
        prop_assert_eq!(found.len(), relaxed.stretches().len());
        for stretch in relaxed.stretches() {
            let violation = found.iter().find(|v| v.name == stretch.name.to_string()).unwrap();
            prop_assert!((violation.amount - stretch.amount).abs() < 1e-5);
        }
    }

    /// Continuous variables, dynamics and a switch; what is named is built anew and solved.
    #[test]
    fn sets_of_continuous_models_are_checked_by_solves(
        rows in prop::collection::vec(
            (0..5usize, prop::collection::vec(-2..=2i32, 4), -6..=6i32, any::<bool>()), 4..14),
    ) {
        let build = |keep: &dyn Fn(&Name) -> bool| {
            let mut model = Model::new("random");
            let x = model.continuous_family("x", 3, -5.0, 5.0).unwrap();
            let z = model.binary("z").unwrap();
            model.add("switch", z.on().implies(x[0].ge(x[1] + 2.0))).unwrap();
            model.set_background("switch").unwrap();
            for (step, (family, terms, limit, at_least)) in rows.iter().enumerate() {
                let name = Name::from((format!("f{family}"), step));
                let all = terms.iter().map(|&a| f64::from(a)).zip(x.iter().chain([z]));
                let sum: Affine = all.map(|(a, v)| a * v).sum();
                let limit = f64::from(*limit);
                let row = if *at_least { sum.ge(limit) } else { sum.le(limit) };
                if keep(&name) {
                    // Rows without variables are refused, here and there.
                    let _ = model.add(name, row);
                }
            }
            model
        };
        let solver = &mut BranchAndBound::default();
        let why = infeasibility(&build(&|_| true), &ExplainOptions::default(), solver).unwrap();
        if why.status() == ExplanationStatus::Feasible {
            prop_assert!(solver.solve(&build(&|_| true)).unwrap().point().is_some());
            return Ok(());
        }
        prop_assert!(why.is_irreducible());
        let named: Vec<Name> =
            why.groups().iter().flat_map(|g| g.statements().iter().cloned()).collect();
        prop_assert!(solver.solve(&build(&|name| named.contains(name))).unwrap().is_infeasible());
        for group in why.groups() {
            let rest = build(&|name| {
                name.family() != group.name() && why.groups().iter().any(|g| g.name() == name.family())
            });
            prop_assert!(solver.solve(&rest).unwrap().point().is_some(), "{} in {}", group, why);
        }
    }
}
