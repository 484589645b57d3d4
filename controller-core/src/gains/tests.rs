use super::*;
use crate::certificate::tests::paper;

#[test]
fn gains_that_the_law_is_not_made_for_are_refused_by_name() {
    let vehicle = *paper().vehicle();
    let refused = |gains| Gains::new(gains, &vehicle).unwrap_err();
    let table = GainParameters::TABLE_1;
    for (gains, field, reason) in [
        (GainParameters { k_p: 1.1e3, ..table }, "gains.k_p", Reason::Above(1e3)),
        (GainParameters { k_s: 9e-8, ..table }, "gains.k_s", Reason::Below(1e-7)),
        (GainParameters { m_p: 9.81, ..table }, "gains.m_p", Reason::NotBelow(9.81)),
        (GainParameters { alpha: 1.0, ..table }, "gains.alpha", Reason::NotBelow(1.0)),
    ] {
        assert_eq!(refused(gains), ParameterError { field, reason });
    }
    assert!(Gains::new(table, &vehicle).is_ok());
}
