use super::*;

#[test]
fn derivatives_and_rates_say_the_same() {
    let (sin, cos) = (0.6_f32, 0.8_f32);
    let heading = Heading::new(Vector2::new(cos, sin), 1.5, -0.7).unwrap();
    let again = Heading::from_derivatives(heading.direction(), heading.first_derivative(), heading.second_derivative());
    let again = again.unwrap();
    assert!((again.rate() - 1.5).abs() < 1e-6 && (again.acceleration() + 0.7).abs() < 1e-6);
}

#[test]
fn a_heading_is_restored_bit_for_bit_from_its_numbers() {
    let phases = (0..10_000_u64).map(|number| number.wrapping_mul(0x9E37_79B9_7F4A_7C15));
    for heading in phases.map(|phase| Heading::from_phase(phase, 0.3, -0.2)) {
        assert_eq!(Heading::restored(heading.direction(), heading.rate(), heading.acceleration()), Ok(heading));
    }
    let off = Heading::restored(Vector2::new(1.0 + 1e-6, 0.0), 0.0, 0.0);
    assert_eq!(off.unwrap_err().reason, Reason::NotOnCircle);
}

#[test]
fn a_derivative_off_the_circle_is_refused() {
    for out in [0.5, -0.5] {
        let error = Heading::from_derivatives(
            Vector2::x(),
            Vector2::new(out, 0.0),
            // As if it turned by so much.
            Vector2::new(-out * out, 0.0),
        );
        assert_eq!(error.unwrap_err().field, "heading.derivatives");
        // Where it does not turn, nothing bends it either way.
        let error = Heading::from_derivatives(Vector2::x(), Vector2::zeros(), Vector2::new(out, 0.0));
        assert_eq!(error.unwrap_err().field, "heading.derivatives");
    }
}

#[test]
fn a_direction_that_is_no_unit_vector_is_refused() {
    assert_eq!(Heading::new(Vector2::new(0.5, 0.5), 0.0, 0.0).unwrap_err().reason, Reason::NotOnCircle);
    assert_eq!(Heading::new(Vector2::new(f32::NAN, 0.5), 0.0, 0.0).unwrap_err().reason, Reason::NotFinite);
}
