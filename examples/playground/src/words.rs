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
    check: Option<PlanCheck>,
    time_step: f64,
}

/// How a plan was checked.
#[derive(Debug, Clone, Copy)]
pub enum PlanCheck {
    /// A simulator replayed it.
    Replayed {
        /// How far that is from the plan, in m.
        drift: f64,
        /// How far the plan is from continuous motion, in m; in scenes, in a step with a hit.
        apart: f64,
    },
    /// Interval simulation found that it holds for every gust.
    EveryGust {
        /// How many flights through random gusts were simulated as well.
        flights: usize,
        /// How many of them keep the plan and end at the goal.
        arrived: usize,
    },
}

impl PlanCheck {
    /// The replay that a plan comes with.
    pub fn of(certificate: &SceneCertificate) -> Self {
        PlanCheck::Replayed { drift: certificate.drift, apart: certificate.step_error }
    }
}

impl<'a> Finding<'a> {
    /// The shortest plan, beside a wall or of a scene, and how it was checked.
    pub fn new<P>(
        found: &'a ShortestHorizon<P>,
        check: impl Fn(&P) -> PlanCheck,
        time_step: f64,
    ) -> Self {
        Finding {
            status: found.status,
            steps: found.steps,
            refuted: found.refuted_steps,
            attempts: &found.attempts,
            check: found.plan.as_ref().map(check),
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

    /// This side without collisions, beside that with collisions: what is impossible there is
    /// impossible here.
    pub fn beside(self, tolerant: &Finding<'a>) -> Self {
        match self.status {
            ShortestStatus::Stopped(_) if tolerant.refuted > self.refuted => {
                let status = if tolerant.is_none() { tolerant.status } else { self.status };
                Finding { status, refuted: tolerant.refuted, attempts: tolerant.attempts, ..self }
            }
            _ => self,
        }
    }

    /// Whether the shortest plan was found and proved.
    pub fn is_found(&self) -> bool {
        self.status == ShortestStatus::Found
    }

    /// Whether it is proved that there is no plan.
    pub fn is_none(&self) -> bool {
        matches!(self.status, ShortestStatus::NoneWithin { .. })
    }

    /// The plan's duration, in s.
    pub fn seconds(&self) -> Option<f64> {
        Some(self.steps? as f64 * self.time_step)
    }

    /// What every plan takes at least, in s.
    pub fn least(&self) -> f64 {
        (self.refuted.unwrap_or(0) + 1) as f64 * self.time_step
    }

    fn known(&self) -> Known {
        match (self.status, self.seconds()) {
            (ShortestStatus::NoneWithin { .. }, _) => Known::Never,
            (ShortestStatus::Found, Some(seconds)) => Known::Shortest(seconds),
            (_, Some(most)) => Known::Between(self.least(), most),
            (_, None) => Known::Open(self.least()),
        }
    }
}

/// What is known of the shortest plan; times in s.
enum Known {
    /// There is none.
    Never,
    Shortest(f64),
    /// There is a plan; the shortest takes from the first to the second.
    Between(f64, f64),
    /// Whether there is a plan is open; it takes at least so long.
    Open(f64),
}

impl Known {
    /// As the end of a sentence that begins with the plan.
    fn words(&self) -> String {
        match *self {
            Known::Never => "there is none".into(),
            Known::Shortest(seconds) => format!("it takes {} s", number(seconds)),
            Known::Between(least, most) => {
                format!("it takes {} s or more and {} s or less", number(least), number(most))
            }
            Known::Open(least) => format!("it takes {} s or more, if there is one", number(least)),
        }
    }
}

/// How the words of a task differ.
pub struct Nouns {
    /// What the plans with collisions do, as the subject of a sentence.
    pub hitting: &'static str,
    /// A plan that does so.
    pub plan: &'static str,
}

/// What comes out of the comparison of the plans without and with collisions. What is said to be
/// so is proved; what is not decided is said to be open.
pub fn conclusion(
    free: &Finding<'_>,
    tolerant: &Finding<'_>,
    nouns: &Nouns,
    longest: f64,
) -> String {
    let Nouns { hitting, plan } = nouns;
    let (slow, fast) = (free.known(), tolerant.known());
    match (&slow, &fast) {
        (_, Known::Never) => {
            format!("There is no plan, with or without collisions, of {longest} s or less.")
        }
        (Known::Never, Known::Shortest(_)) => {
            format!("Only {plan} gets there: without an impact there is no plan.")
        }
        (Known::Never, Known::Between(least, most)) => format!(
            "Only {plan} gets there: without an impact there is no plan. The shortest takes {} s or \
             more and {} s or less.",
            number(*least),
            number(*most)
        ),
        (Known::Never, Known::Open(least)) => format!(
            "Without an impact there is no plan. Whether {plan} gets there is open; it takes {} s \
             or more.",
            number(*least)
        ),
        (Known::Shortest(slow), Known::Shortest(fast)) if slow > fast => {
            let (saved, share) = (slow - fast, 100.0 * (slow - fast) / slow);
            format!("{hitting} saves {saved:.3} s, {share:.1} % of the careful plan's time.")
        }
        (Known::Shortest(_), Known::Shortest(_)) => {
            format!("{hitting} does not pay here: it makes no plan any faster.")
        }
        (Known::Shortest(slow), Known::Between(least, most)) if most < slow => format!(
            "{hitting} saves {} s at least. Whether there is a faster plan still is open; it takes \
             {} s or more.",
            number(slow - most),
            number(*least)
        ),
        (Known::Shortest(slow), Known::Between(least, _) | Known::Open(least)) => format!(
            "Without an impact it takes {} s. Whether {plan} is faster is open; it takes {} s or \
             more.",
            number(*slow),
            number(*least)
        ),
        (Known::Between(..) | Known::Open(_), _) => format!(
            "Not decided. Of the shortest plan without an impact is known: {}. With collisions \
             allowed: {}.",
            slow.words(),
            fast.words()
        ),
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
    let possible = match (found.check, found.steps) {
        (Some(PlanCheck::Replayed { drift, .. }), Some(count)) => format!(
            " The plan of {} was replayed by a simulator, step by step, to within {:.0e} m.",
            steps(count),
            drift.max(1e-15)
        ),
        (Some(PlanCheck::EveryGust { flights, arrived }), Some(count)) => format!(
            " Interval simulation shows that the plan of {} holds for every gust. Of {flights} flights \
             through random gusts, {arrived} keep the plan and end at the goal.",
            steps(count)
        ),
        _ => String::new(),
    };
    let stopped = match found.status {
        ShortestStatus::Stopped(_) => {
            format!(" The search for a plan of {} steps was stopped.", refuted + 1)
        }
        _ => String::new(),
    };
    let apart = match found.check {
        Some(PlanCheck::Replayed { apart, .. }) if apart >= 0.005 && found.time_step >= 0.05 => {
            format!(
                " Between samples the discrete law is up to {apart:.2} m away from continuous motion: \
             smaller steps agree better."
            )
        }
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

/// A number with at most three digits after the point: those of a multiple of a time step.
pub fn number(value: f64) -> String {
    let text = format!("{value:.3}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}
