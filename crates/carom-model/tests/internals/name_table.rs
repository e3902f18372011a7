//! The table from names to positions.

use carom_model::internals::model::NameTable;

#[test]
fn names_are_claimed_once_in_any_order() {
    let mut table = NameTable::default();
    let names = ["x[0]", "x", "x[2]", "x[1]", "x[2]", "x[0]", "x[3]", "y[7]", "x"];
    let claimed: Vec<bool> =
        names.iter().enumerate().map(|(k, &name)| table.claim(&name.into(), k)).collect();
    assert_eq!(claimed, [true, true, true, true, false, false, true, true, false]);
    let found = |table: &NameTable<usize>, name: &str| table.get(&name.into());
    assert_eq!(
        ["x", "x[0]", "x[1]", "x[2]", "x[3]", "x[4]", "y", "y[7]"].map(|n| found(&table, n)),
        [Some(1), Some(0), Some(3), Some(2), Some(6), None, None, Some(7)]
    );
    for name in ["x", "x[2]", "x[1]", "z", "y[8]"] {
        table.remove(&name.into());
        assert_eq!(found(&table, name), None);
        assert!(table.claim(&name.into(), 9));
    }
}
