//! Searches for a shortest horizon that are interrupted.

use carom::hybrid::{
    HorizonEvent, HorizonModel, HorizonVerdict, Monotonicity, ShortestOptions, ShortestStatus,
    shortest_horizon,
};
use carom::prelude::*;

/// Without a plan below 5 steps, hard to refute at 5 and 6, and easy from 9 on.
struct Stubborn {
    waits: bool,
    /// From which number of steps on there is a plan.
    easy: usize,
}

impl HorizonModel for Stubborn {
    type Program = Model;

    fn build(&self, steps: usize) -> Result<Model, Error> {
        let mut model = Model::new("stubborn");
        let count = if steps < 5 { 2 } else { 26 };
        let z = model.binary_family("z", count)?;
        if steps >= self.easy {
            return Ok(model);
        }
        let mut state: u64 = 11;
        let mut draw = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            ((state >> 33) % 100) as f64
        };
        if steps < 5 {
            model.add("never", (z[0] + z[1]).ge(3.0))?;
            return Ok(model);
        }
        // Sums that are met by no choice: each can be met by itself.
        for row in 0..4 {
            let factors: Vec<f64> = z.iter().map(|_| draw()).collect();
            let half = (factors.iter().sum::<f64>() / 2.0).floor();
            let sum: Affine = z.iter().zip(&factors).map(|(z, a)| *a * z).sum();
            model.add(("row", row), sum.equals(half))?;
        }
        Ok(model)
    }

    fn monotonicity(&self) -> Monotonicity {
        match self.waits {
            true => Monotonicity::Monotone("it is a test".into()),
            false => Monotonicity::NotMonotone("it is a test".into()),
        }
    }
}

/// Stops when the search of 5 steps begins with the easy plan at hand.
fn interrupted(
    waits: bool,
    easy: usize,
) -> (Option<usize>, Option<usize>, ShortestStatus, Vec<usize>) {
    let interrupt = Interrupt::new();
    let trigger = interrupt.clone();
    let stop = move |event: &HorizonEvent| {
        if let HorizonEvent::Started { steps: 5, feasible, .. } = event
            && *feasible == Some(easy)
        {
            trigger.trigger();
        }
    };
    let options = ShortestOptions::default()
        .with_max_steps(400)
        .with_interrupt(&interrupt)
        .with_progress(stop);
    let mut solver = BranchAndBound::default();
    let own = Stubborn { waits, easy };
    let found = shortest_horizon(&own, &options, &mut solver).unwrap();
    assert_eq!(found.plan.is_some(), found.steps.is_some());
    assert!(found.plan.iter().all(|plan| plan.solution.point().is_some()));
    let open = found.attempts.iter().filter(|a| matches!(a.verdict, HorizonVerdict::Undecided(_)));
    let tried = open.map(|attempt| attempt.steps).collect();
    (found.steps, found.refuted_steps, found.status, tried)
}

#[test]
fn an_interrupted_search_has_a_plan_and_a_bound() {
    for waits in [false, true] {
        for easy in [9, 6, 20] {
            let (steps, refuted, status, tried) = interrupted(waits, easy);
            // The last undecided one is the interrupted search.
            assert_eq!(steps, Some(easy), "{tried:?}");
            assert_eq!(refuted, Some(4));
            assert_eq!(status, ShortestStatus::Stopped(Termination::Interrupted));
        }
    }
}

#[test]
fn looks_change_no_answer() {
    // A horizon that takes more than a look, and is refuted in the end.
    struct Slow(bool);
    impl HorizonModel for Slow {
        type Program = Model;

        fn build(&self, steps: usize) -> Result<Model, Error> {
            let mut model = Model::new("slow");
            let z = model.binary_family("z", 16)?;
            if steps == 5 || steps > 7 {
                let (first, second): (Affine, Affine) = z
                    .iter()
                    .enumerate()
                    .map(|(k, z)| {
                        let k = k as f64;
                        ((37.0 + 11.0 * k * k % 61.0) * z, (53.0 + 29.0 * k * k % 47.0) * z)
                    })
                    .fold((Affine::zero(), Affine::zero()), |(a, b), (c, d)| (a + c, b + d));
                if steps == 5 {
                    model.add("first", first.equals(411.0))?;
                    model.add("second", second.equals(402.0))?;
                }
            } else {
                model.add("never", (z[0] + z[1]).ge(3.0))?;
            }
            Ok(model)
        }

        fn monotonicity(&self) -> Monotonicity {
            match self.0 {
                true => Monotonicity::Monotone("it is a test".into()),
                false => Monotonicity::NotMonotone("it is a test".into()),
            }
        }
    }
    let mut steps = Vec::new();
    for waits in [false, true] {
        let options = ShortestOptions::default().with_max_steps(40);
        let mut solver = BranchAndBound::default();
        let found = shortest_horizon(&Slow(waits), &options, &mut solver).unwrap();
        assert_eq!(found.status, ShortestStatus::Found, "{:?}", found.attempts);
        assert_eq!(found.refuted_steps, found.steps.map(|steps| steps - 1));
        steps.push(found.steps);
    }
    assert!(steps[0] == Some(5) || steps[0] == Some(8), "{steps:?}");
}
