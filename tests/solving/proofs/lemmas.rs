//! Programs whose trees are small because big-Ms are smaller, bounds hold in all cases, or cuts are
//! added: their logs begin with lemmas, and are small as well.

use super::is_proved;
use crate::instances::suite::suite;

#[test]
fn trees_that_smaller_big_ms_close_have_small_logs() {
    for (name, most) in [("pendulum_60_bigm", 200_000), ("pendulum_40_bigm", 200_000)] {
        let instances = suite(&[name.to_owned()]);
        let [(_, model, _)] = &instances[..] else { panic!("{name} is one program") };
        let solution = is_proved(model, &format!("lemmas_{name}"));
        let commands = solution.proof().map_or(u64::MAX, |proof| proof.commands);
        assert!(commands < most, "{name}: {commands} commands");
    }
}
