//! The declaration of the constants, and what their ranges refuse.

use crate::allocation::{QuadX, Rotors};
use crate::error::{ParameterError, Reason};
use crate::extended::actuators::ActuatorParameters;
use crate::extended::parameters::{Extended, ExtendedParameters};
use crate::extended::tests::example::{self, Craft};

#[test]
fn a_lag_longer_than_anything_is_held_for_as_long_as_can_be_counted() {
    assert_eq!(ActuatorParameters { lag: 1e9, delay: 0.0 }.settling(0.1), u32::MAX);
}

/// The example with one constant changed.
fn refused(key: &str, value: f32) -> ParameterError {
    let mut values = example::parameters().values();
    values[example::place(key)] = value;
    Extended::new(ExtendedParameters::from_values(values), &example::vehicle()).unwrap_err()
}

#[test]
fn every_constant_is_refused_by_its_name_on_either_side_of_its_range() {
    for constant in ExtendedParameters::TABLE {
        let beyond = |reason| ParameterError { field: constant.path, reason };
        let (min, max) = (constant.range.min, constant.range.max);
        let below = if min > 0.0 { Reason::Below(min) } else { Reason::Negative };
        assert_eq!(refused(constant.key, min.next_down()), beyond(below));
        assert_eq!(refused(constant.key, max.next_up()), beyond(Reason::Above(max)));
        assert_eq!(refused(constant.key, f32::NAN), beyond(Reason::NotFinite));
    }
}

#[test]
fn constants_that_leave_nothing_of_one_another_are_refused_by_name() {
    let p = example::parameters();
    let beyond = |field, reason| ParameterError { field, reason };
    assert_eq!(refused("a_down", 9.81), beyond("gains.a_down", Reason::NotBelow(9.81)));
    assert_eq!(refused("force_up", p.a_down), beyond("estimates.force_up", Reason::NotBelow(p.a_down)));
    assert_eq!(refused("force_across", p.a_across), beyond("estimates.force_across", Reason::NotBelow(p.a_across)));
}

#[test]
fn a_margin_that_rounding_could_use_up_is_refused_with_the_rotors() {
    let craft = Craft::example();
    let with = |floor_margin: f32| {
        let law = craft.law(&ExtendedParameters { floor_margin, ..example::parameters() });
        law.parameters.check_rotors(&craft.rotors)
    };
    let max = craft.rotors.iter().map(|rotor| rotor.thrust_max).sum::<f32>();
    let min = Extended::FLOOR_MARGIN_SHARE_MIN * example::parameters().scale_greatest * max;
    assert_eq!(with(1.001 * min), Ok(()));
    let ParameterError { field, reason } = with(0.999 * min).unwrap_err();
    assert!(field == "gains.floor_margin" && matches!(reason, Reason::Below(_)), "{reason:?}");
}

#[test]
fn rotors_whose_drag_hardly_yaws_are_refused() {
    let craft = Craft::example();
    let with = |share: f32| {
        let rotors =
            Rotors::quad_x(QuadX { drag_coefficient: share * example::QUAD.drag_coefficient, ..example::QUAD });
        craft.law(&example::parameters()).parameters.check_rotors(&rotors.unwrap())
    };
    assert_eq!(with(0.1), Ok(()));
    assert_eq!(with(1e-6).unwrap_err(), ParameterError { field: "rotors.position", reason: Reason::DoesNotSpan });
}

#[test]
fn the_table_names_each_constant_once_with_its_place() {
    let values = core::array::from_fn(|place| place as f32);
    assert_eq!(ExtendedParameters::from_values(values).values(), values);
    for (place, constant) in ExtendedParameters::TABLE.iter().enumerate() {
        assert_eq!(example::place(constant.key), place);
        assert_eq!(constant.path.split_once('.'), Some((constant.section, constant.key)));
    }
}
