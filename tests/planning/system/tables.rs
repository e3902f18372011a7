//! Tables of runs as text.

use carom::hybrid::HybridRun;

#[test]
fn remainders_of_zero_are_zero() {
    let mut run = HybridRun::default();
    run.time_step = 0.5;
    run.states = vec![
        ("x".into(), vec![1.0, -3.7e-14, 0.1 + 0.2]),
        ("still".into(), vec![1e-14, -2e-17, 0.0]),
        ("small".into(), vec![1e-9, 2e-10, 5e-22]),
    ];
    let expected = "time,x,still,small\n0,1,0,1e-9\n0.5,0,0,2e-10\n1,0.3,0,0\n";
    assert_eq!(run.to_csv(), expected);
}
