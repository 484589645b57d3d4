use super::*;

const FLAT: VehicleParameters =
    VehicleParameters { mass: 0.5, inertia: Vector3::new(1e-3, 2e-3, 3.1e-3), gravity: 9.81 };

#[test]
fn an_inertia_is_some_bodys_to_within_what_measuring_it_takes() {
    assert!(Vehicle::new(FLAT).is_ok());
    let flatter = VehicleParameters { inertia: Vector3::new(1e-3, 2e-3, 3.2e-3), ..FLAT };
    let error = ParameterError { field: "vehicle.inertia", reason: Reason::TriangleInequality };
    assert_eq!(Vehicle::new(flatter).unwrap_err(), error);
}

#[test]
fn limits_that_do_not_let_it_hover_are_refused() {
    let vehicle = Vehicle::new(FLAT).unwrap();
    let hover = vehicle.mass * vehicle.gravity;
    let limits = |thrust_max| Limits::new(LimitParameters { thrust_max, torque_max: Vector3::repeat(1.0) }, &vehicle);
    assert!(limits(hover.next_up()).is_ok());
    let error = ParameterError { field: "limits.thrust_max", reason: Reason::NotAbove(hover) };
    assert_eq!(limits(hover).unwrap_err(), error);
}
