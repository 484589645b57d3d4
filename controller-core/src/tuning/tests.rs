use super::judged::JudgedLoops;
use super::*;
use crate::hummingbird;

fn built() -> Configuration {
    hummingbird::certified().configuration().clone()
}

#[test]
fn a_tuning_that_changes_nothing_is_the_built_configuration_to_the_bit() {
    let built = built();
    let tuning = Tuning { figures: Figures::from_configuration(&built), factors: Factors::BUILT };
    assert_eq!(tuning.apply(&built).unwrap(), built);
}

#[test]
fn each_figure_arrives_where_the_certificate_looks() {
    let built = built();
    let figures = Figures::from_configuration(&built);
    let apply = |figures| Tuning { figures, factors: Factors::BUILT }.apply(&built).unwrap();
    assert_eq!(apply(Figures { mass: 0.5, ..figures }).vehicle().mass, 0.5);
    assert_eq!(apply(Figures { thrust_max: 8.0, ..figures }).limits().thrust_max, 8.0);
    let bounds = ReferenceBounds { jerk: 0.1, ..figures.bounds };
    assert_eq!(apply(Figures { bounds, ..figures }).bounds().jerk, 0.1);
    let rotors = apply(Figures { rotor_thrust: [0.01, 3.0], ..figures });
    assert!(rotors.rotors().unwrap().iter().all(|rotor| (rotor.thrust_min, rotor.thrust_max) == (0.01, 3.0)));
}

#[test]
fn rotors_that_differ_keep_the_thrusts_that_were_not_changed() {
    let mut rotors: Vec<Rotor, 4> = built().rotors().unwrap().iter().copied().collect();
    (rotors[2].thrust_min, rotors[2].thrust_max) = (0.02, 2.9);
    let built = built().with_rotors(Rotors::new(&rotors).unwrap()).unwrap();
    let figures = Figures::from_configuration(&built);
    let third = |rotor_thrust| {
        let tuning = Tuning { figures: Figures { rotor_thrust, ..figures }, factors: Factors::BUILT };
        let rotor = tuning.apply(&built).unwrap().rotors().unwrap()[2];
        (rotor.thrust_min, rotor.thrust_max)
    };
    let [min, max] = figures.rotor_thrust;
    assert_eq!(third([min, max]), (0.02, 2.9));
    assert_eq!(third([0.01, max]), (0.01, 2.9));
    assert_eq!(third([min, 2.5]), (0.02, 2.5));
}

#[test]
fn the_papers_law_has_no_gains_of_its_own_for_the_vertical() {
    let built = built();
    let other = Percent::new(90.0).unwrap();
    for (factors, field) in [
        (Factors { position_vertical: other, ..Factors::BUILT }, "gains.k_p_vertical"),
        (Factors { velocity_vertical: other, ..Factors::BUILT }, "gains.k_v_vertical"),
    ] {
        let error = Tuning { figures: Figures::from_configuration(&built), factors }.apply(&built).unwrap_err();
        assert_eq!(error, ParameterError { field, reason: Reason::OtherLaw });
    }
}

#[test]
fn what_no_vehicle_could_be_is_refused_by_field() {
    let built = built();
    let figures = Figures::from_configuration(&built);
    let refused = |figures| Tuning { figures, factors: Factors::BUILT }.apply(&built).unwrap_err().field;
    assert_eq!(refused(Figures { mass: f32::NAN, ..figures }), "vehicle.mass");
    assert_eq!(refused(Figures { mass: 100.0, ..figures }), "limits.thrust_max");
    assert_eq!(refused(Figures { rotor_thrust: [1.0, 0.5], ..figures }), "rotors.thrust_min, rotor 1");
}

#[test]
fn factors_are_those_of_the_list_and_no_others() {
    for percent in [70.0, 100.0, 130.0] {
        assert_eq!(Percent::new(percent).unwrap().percent(), percent);
    }
    assert_eq!(Percent::new(100.0), Some(Percent::AS_BUILT));
    for percent in [60.0, 69.9, 75.0, 140.0, f32::NAN, f32::INFINITY] {
        assert_eq!(Percent::new(percent), None);
    }
    assert_eq!(Percent::all().count(), Percent::COUNT);
}

#[test]
fn a_choice_of_factors_holds_where_it_was_judged_to_and_nowhere_else() {
    let seventy = Percent::new(70.0).unwrap();
    let good = |factors: &Factors| factors.rate == seventy && factors.velocity_across == Percent::AS_BUILT;
    let upright = |factors: &Factors| factors.position_vertical != seventy;
    let judged = JudgedLoops::judge(good, upright);
    let (across, vertical) = judged.bits();
    assert_eq!(JudgedLoops::from_bits(*across, *vertical), judged);
    let bits = |bits: &[u8]| bits.iter().map(|byte| byte.count_ones()).sum::<u32>();
    assert_eq!((bits(across), bits(vertical)), (49, 42));
    for attitude in Percent::all() {
        for rate in Percent::all() {
            for position_vertical in Percent::all() {
                let factors = Factors { attitude, rate, position_vertical, ..Factors::BUILT };
                assert_eq!(judged.hold(&factors), good(&factors) && upright(&factors), "{factors:?}");
            }
        }
    }
}

#[test]
fn without_a_judgement_only_the_gains_as_built_hold() {
    let factors = |rate, velocity_vertical| Factors { rate, velocity_vertical, ..Factors::BUILT };
    for rate in Percent::all() {
        for vertical in Percent::all() {
            let holds = JudgedLoops::BUILT.hold(&factors(rate, vertical));
            assert_eq!(holds, (rate, vertical) == (Percent::AS_BUILT, Percent::AS_BUILT));
        }
    }
}
