use super::*;
use crate::certificate::certified::Certified;
use crate::extended::tests::Random;
use crate::extended::tests::example::Craft;

#[test]
fn every_plausible_vehicle_is_certified_from_its_numbers_with_references_to_fly() {
    let mut random = Random(31);
    for _ in 0..100 {
        let craft = Craft::random(&mut random);
        let certified = Certified::new(Configuration::from_airframe(&craft.airframe()).unwrap()).unwrap();
        let bounds = certified.configuration().bounds();
        assert!(bounds.values().iter().all(|&bound| bound > 0.0), "{craft:?}: {bounds:?}");
    }
}

#[test]
fn the_widest_references_are_a_share_of_the_formulas() {
    let mut random = Random(32);
    for _ in 0..100 {
        let craft = Craft::random(&mut random);
        let airframe = craft.airframe();
        let parameters = craft.constants(&NOTHING_GIVEN);
        let max = defaults::reference_bounds(&airframe, &parameters);
        let widest = flyable(&airframe, craft.law(&parameters));
        assert!(widest.values().iter().zip(max.values()).all(|(bound, max)| *bound <= max), "{widest:?}");
    }
}
