//! The messages' schemas. Those named foxglove have the fields of Foxglove's own, which is how its panels know them.

/// A name and a JSON schema.
pub struct Schema {
    /// As readers know it.
    pub name: &'static str,
    /// Its text.
    pub text: &'static str,
}

/// A time, a vector and a quaternion, as the others use them.
macro_rules! parts {
    (time) => {
        r#"{"type":"object","title":"time","properties":{"sec":{"type":"integer","minimum":0},"nsec":{"type":"integer","minimum":0,"maximum":999999999}}}"#
    };
    (vector) => {
        r#"{"type":"object","properties":{"x":{"type":"number"},"y":{"type":"number"},"z":{"type":"number"}}}"#
    };
    (quaternion) => {
        r#"{"type":"object","properties":{"x":{"type":"number"},"y":{"type":"number"},"z":{"type":"number"},"w":{"type":"number"}}}"#
    };
    (pose) => {
        concat!(r#"{"type":"object","properties":{"position":"#, parts!(vector), r#","orientation":"#, parts!(quaternion), "}}")
    };
}

/// A pose in a frame.
pub const POSE_IN_FRAME: Schema = Schema {
    name: "foxglove.PoseInFrame",
    text: concat!(
        r#"{"type":"object","properties":{"timestamp":"#,
        parts!(time),
        r#","frame_id":{"type":"string"},"pose":"#,
        parts!(pose),
        "}}"
    ),
};

/// Where one frame is in another.
pub const FRAME_TRANSFORM: Schema = Schema {
    name: "foxglove.FrameTransform",
    text: concat!(
        r#"{"type":"object","properties":{"timestamp":"#,
        parts!(time),
        r#","parent_frame_id":{"type":"string"},"child_frame_id":{"type":"string"},"translation":"#,
        parts!(vector),
        r#","rotation":"#,
        parts!(quaternion),
        "}}"
    ),
};

/// Things to be drawn: of all that Foxglove knows, lines.
pub const SCENE_UPDATE: Schema = Schema {
    name: "foxglove.SceneUpdate",
    text: concat!(
        r#"{"type":"object","properties":{"deletions":{"type":"array","items":{"type":"object"}},"entities":{"type":"array","items":{"type":"object","properties":{"timestamp":"#,
        parts!(time),
        r#","frame_id":{"type":"string"},"id":{"type":"string"},"lifetime":"#,
        parts!(time),
        r#","frame_locked":{"type":"boolean"},"metadata":{"type":"array","items":{"type":"object"}},"lines":{"type":"array","items":{"type":"object","properties":{"type":{"type":"integer"},"pose":"#,
        parts!(pose),
        r#","thickness":{"type":"number"},"scale_invariant":{"type":"boolean"},"points":{"type":"array","items":"#,
        parts!(vector),
        r#"},"color":{"type":"object","properties":{"r":{"type":"number"},"g":{"type":"number"},"b":{"type":"number"},"a":{"type":"number"}}},"colors":{"type":"array","items":{"type":"object"}},"indices":{"type":"array","items":{"type":"integer"}}}}}}}}}}"#
    ),
};

/// The law's commands: N, N m; and its errors: m, modified Rodrigues parameters.
pub const LAW_SCHEMA: Schema = Schema {
    name: "host_sim.Law",
    text: concat!(
        r#"{"type":"object","properties":{"thrust":{"type":"number"},"torque":"#,
        parts!(vector),
        r#","position_error":{"type":"number"},"attitude_error":{"type":"number"},"lift_sign":{"type":"number"},"feedback":"#,
        parts!(vector),
        r#","clipped":{"type":"boolean"}}}"#
    ),
};

/// Each rotor's thrust, N.
pub const ROTORS_SCHEMA: Schema = Schema {
    name: "host_sim.Rotors",
    text: r#"{"type":"object","properties":{"thrust":{"type":"array","items":{"type":"number"}}}}"#,
};

/// The law's estimates: m/s^2, N m, and a factor.
pub const ESTIMATES_SCHEMA: Schema = Schema {
    name: "host_sim.Estimates",
    text: concat!(
        r#"{"type":"object","properties":{"force":"#,
        parts!(vector),
        r#","torque":"#,
        parts!(vector),
        r#","thrust_scale":{"type":"number"}}}"#
    ),
};

/// The firmware's state: mode in words, V, s, a factor, a count; an unknown value is null.
pub const STATE_SCHEMA: Schema = Schema {
    name: "host_sim.State",
    text: r#"{"type":"object","properties":{"mode":{"type":"string"},"ready":{"type":"boolean"},"airborne":{"type":"boolean"},"battery":{"type":["number","null"]},"pose_age":{"type":["number","null"]},"thrust_scale":{"type":["number","null"]},"missed_ticks":{"type":"integer"}}}"#,
};

/// A text with its time.
pub const LOG_SCHEMA: Schema = Schema {
    name: "foxglove.Log",
    text: concat!(
        r#"{"type":"object","properties":{"timestamp":"#,
        parts!(time),
        r#","level":{"type":"integer"},"message":{"type":"string"},"name":{"type":"string"},"file":{"type":"string"},"line":{"type":"integer"}}}"#
    ),
};
