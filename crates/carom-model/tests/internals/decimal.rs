//! Exact sums of decimal numbers.

use carom_model::internals::model::Decimal;

fn sum(a: &str, b: &str) -> String {
    let (a, b) = (Decimal::parse(a).unwrap(), Decimal::parse(b).unwrap());
    a.plus(&b).map_or("none".into(), |sum| sum.to_string())
}

#[test]
fn sums_are_exact() {
    assert_eq!(sum("1.1", "1.2"), "2.3");
    assert_eq!(sum("0.1", "0.2"), "0.3");
    assert_eq!(sum("99.9", "0.1"), "100");
    assert_eq!(sum("1", "-2.5"), "-1.5");
    assert_eq!(sum("-2.5", "1"), "-1.5");
    assert_eq!(sum("-0.5", "0.5"), "0");
    assert_eq!(sum("+1.5D+02", "-1e2"), "50");
    assert_eq!(sum("1e19", "1"), "10000000000000000001");
    assert_eq!(sum("1e25", "1e-25"), "100000000000000000000000000000000000000000000000001e-25");
    assert_eq!(sum("0", "1e-9"), "1e-9");
    assert_eq!(sum("-0.000", "-0.0"), "0");
}

#[test]
fn what_is_too_wide_is_refused() {
    assert_eq!(sum("1e600", "1e-600"), "none");
    assert_eq!(Decimal::parse("1e99999999999"), None);
    assert!(Decimal::parse("1e-2147483648").and_then(|d| d.plus(&d)).is_some());
    assert_eq!(Decimal::parse("1.5e-2147483648"), None);
    assert_eq!(Decimal::parse("inf"), None);
    assert_eq!(Decimal::parse("1x"), None);
}
