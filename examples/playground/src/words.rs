//! Answers in words.

use carom::hybrid::scene::SceneCertificate;
use carom::hybrid::{
    HorizonAttempt, HorizonRefutation, HorizonVerdict, ShortestHorizon, ShortestStatus,
};

/// What a search for the shortest plan found out.
pub struct Finding<'a> {
    status: ShortestStatus,
    /// The plan's, if there is one.
    pub steps: Option<usize>,
    /// Every horizon up to this one is impossible, in steps.
    pub refuted: Option<usize>,
    attempts: &'a [HorizonAttempt],
    /// How far the replayed plan is from the plan, in m.
    replay: Option<f64>,
    /// How far the plan is from continuous motion, in m; in scenes, in a step with a hit.
    apart: Option<f64>,
    time_step: f64,
}

impl<'a> Finding<'a> {
    /// The shortest plan, beside a wall or of a scene, with its replay.
    pub fn new<P>(
        found: &'a ShortestHorizon<P>,
        replay: impl Fn(&P) -> &SceneCertificate,
        time_step: f64,
    ) -> Self {
        let replay = found.plan.as_ref().map(replay);
        Finding {
            status: found.status,
            steps: found.steps,
            refuted: found.refuted_steps,
            attempts: &found.attempts,
            replay: replay.map(|replay| replay.drift),
            apart: replay.map(|replay| replay.step_error),
            time_step,
        }
    }

    /// This plan, after a search for a shorter one in which more is allowed.
    pub fn after(self, shorter: Finding<'a>) -> Self {
        if shorter.steps.is_some() || self.steps.is_none() {
            return shorter;
        }
        let status = if shorter.is_none() { ShortestStatus::Found } else { shorter.status };
        Finding { status, refuted: shorter.refuted, attempts: shorter.attempts, ..self }
    }

    /// Whether the shortest plan was found and proved.
    pub fn is_found(&self) -> bool {
        self.status == ShortestStatus::Found
    }

    fn is_none(&self) -> bool {
        matches!(self.status, ShortestStatus::NoneWithin { .. })
    }

    /// The plan's duration, in s.
    pub fn seconds(&self) -> Option<f64> {
        Some(self.steps? as f64 * self.time_step)
    }

    /// By how much another plan that is proved to be shorter is shorter, in s.
    fn longer_than(&self, other: &Finding<'_>) -> Option<f64> {
        let (own, other) = (self.seconds()?, other.seconds()?);
        (self.is_found() && own > other).then_some(own - other)
    }
}

/// How the words of a task differ.
pub struct Nouns {
    /// What the plans with collisions do, as the subject of a sentence.
    pub hitting: &'static str,
    /// A plan that does so.
    pub plan: &'static str,
}

/// What comes out of the comparison of the plans without and with collisions.
pub fn conclusion(
    free: &Finding<'_>,
    tolerant: &Finding<'_>,
    nouns: &Nouns,
    longest: f64,
) -> String {
    let Nouns { hitting, plan } = nouns;
    if let (Some(saved), Some(slow), Some(fast)) =
        (free.longer_than(tolerant), free.seconds(), tolerant.seconds())
    {
        let share = 100.0 * (slow - fast) / slow;
        return format!("{hitting} saves {saved:.3} s, {share:.1} % of the careful plan's time.");
    }
    match (free.seconds(), tolerant.seconds()) {
        _ if free.is_none() && tolerant.is_none() => {
            format!("There is no plan, with or without collisions, of {longest} s or less.")
        }
        (None, Some(_)) if free.is_none() => {
            format!("Only {plan} gets there: without an impact there is no plan.")
        }
        _ if free.is_found() && tolerant.is_found() => {
            format!("{hitting} does not pay here: it makes no plan any faster.")
        }
        (None, None) => "The search was stopped before it found a plan.".into(),
        (Some(slow), Some(fast)) if fast < slow => {
            let saved = number(slow - fast);
            format!("{hitting} saves {saved} s at least: the search for faster plans was stopped.")
        }
        (slow, _) => {
            let less = slow.map_or("at all".to_owned(), |s| format!("less than {} s", number(s)));
            match tolerant.refuted {
                Some(refuted) => {
                    let least = number((refuted + 1) as f64 * tolerant.time_step);
                    format!(
                        "{hitting} takes {least} s or more, proved; whether it takes {less} is open."
                    )
                }
                None => format!("Whether {} takes {less} is open.", hitting.to_lowercase()),
            }
        }
    }
}

/// How the shortest horizon of a plan was proved.
pub fn proof(found: &Finding<'_>) -> String {
    let refuted = found.refuted.unwrap_or(0);
    let impossible = match (refuted, found.status) {
        (_, ShortestStatus::NoneWithin { max_steps }) => {
            let longest = (max_steps as f64 * found.time_step * 1e3).round() / 1e3;
            return format!(
                "Every number of steps up to {max_steps} ({longest} s) is impossible{}.",
                how(found)
            );
        }
        (0, _) => String::new(),
        (1, _) => format!("1 step is impossible{}.", how(found)),
        (n, _) => {
            format!("{n} steps are impossible, and so is every smaller number{}.", how(found))
        }
    };
    let possible = match (found.replay, found.steps) {
        (Some(error), Some(steps)) => format!(
            " The plan of {steps} {} was replayed by a simulator, step by step, to within {:.0e} m.",
            if steps == 1 { "step" } else { "steps" },
            error.max(1e-15)
        ),
        _ => String::new(),
    };
    let stopped = match found.status {
        ShortestStatus::Stopped(_) => {
            format!(" The search for a plan of {} steps was stopped.", refuted + 1)
        }
        _ => String::new(),
    };
    let apart = match found.apart {
        Some(apart) if apart >= 0.005 && found.time_step >= 0.05 => format!(
            " Between samples the discrete law is up to {apart:.2} m away from continuous motion: \
             smaller steps agree better."
        ),
        _ => String::new(),
    };
    format!("{impossible}{stopped}{possible}{apart}").trim().to_owned()
}

/// By what the horizons were refuted.
fn how(found: &Finding<'_>) -> String {
    let by = |way| {
        let refuted = HorizonVerdict::Refuted(way);
        found.attempts.iter().filter(|attempt| attempt.verdict == refuted).count()
    };
    let (sets, solves) = (
        by(HorizonRefutation::Sets),
        by(HorizonRefutation::Propagation) + by(HorizonRefutation::Relaxation),
    );
    match (sets, solves) {
        (0, 0) => String::new(),
        (_, 0) => ": reach sets exclude them all, without solving a program".into(),
        (0, _) => format!(": branch and bound refuted {solves} {}", programs(solves)),
        _ => format!(
            ": reach sets exclude {sets} of them, branch and bound refuted {solves} {}",
            programs(solves)
        ),
    }
}

fn programs(count: usize) -> &'static str {
    if count == 1 { "program" } else { "programs" }
}

/// A message as a sentence.
pub fn sentence(text: &str) -> String {
    let mut letters = text.chars();
    let first = letters.next().map(|letter| letter.to_uppercase().to_string());
    let stop = if text.ends_with(['.', '!', '?']) { "" } else { "." };
    format!("{}{}{stop}", first.unwrap_or_default(), letters.as_str())
}

/// So many steps.
pub fn steps(count: usize) -> String {
    if count == 1 { "1 step".into() } else { format!("{count} steps") }
}

/// A number with at most two digits after the point.
pub fn number(value: f64) -> String {
    let text = format!("{value:.2}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}
