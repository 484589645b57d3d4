use super::*;
use serde_json::{Value, json};

fn ask(request: &Value) -> Result<Value, String> {
    let mut answer: Value = serde_json::from_str(&answer(&request.to_string())).unwrap();
    match answer["error"].as_str() {
        Some(error) => Err(error.to_owned()),
        None => Ok(answer["ok"].take()),
    }
}

fn preset(id: &str) -> String {
    presets::all().into_iter().find(|preset| preset.id == id).unwrap().text.to_owned()
}

fn certify(file: &str, text: &str) -> Result<Value, String> {
    ask(&json!({"do": "certify", "file": file, "text": text}))
}

/// A flight of `task` in still air, changed by `changes`.
fn fly(text: &str, task: &str, changes: &Value) -> Result<Value, String> {
    let mut request =
        json!({"task": task, "wind": 0.0, "mass": 1.0, "weak_rotor": 0, "weak_share": 1.0, "laws": ["ours", "indi"]});
    request.as_object_mut().unwrap().extend(changes.as_object().unwrap().clone());
    ask(&json!({"do": "fly", "file": "mine.toml", "text": text, "request": request}))
}

#[test]
fn every_preset_is_certified_and_hovers_again_from_upside_down_without_a_cut_command() {
    for preset in presets::all() {
        let verdict = certify(preset.file, preset.text).unwrap();
        assert_eq!((&verdict["certified"], &verdict["decision"]), (&json!(true), &json!("CERTIFIED")), "{}", preset.id);
        let flown = fly(preset.text, "upside_down", &json!({"laws": ["ours"]})).unwrap();
        let ours = &flown["flights"][0];
        assert_eq!((&ours["figures"]["cut"], &ours["ended"]), (&json!(0), &Value::Null), "{}", preset.id);
        assert!(ours["figures"]["settled"].as_f64().unwrap() < 20.0, "{}: {}", preset.id, ours["figures"]);
        assert!(ours["tilt"][0].as_f64().unwrap() > 170.0);
    }
}

#[test]
fn a_verdict_says_what_the_terminal_says() {
    let verdict = certify("hummingbird.toml", &preset("hummingbird")).unwrap();
    let report = verdict["report"].as_str().unwrap();
    for row in verdict["rows"].as_array().unwrap() {
        assert!(report.contains(row["name"].as_str().unwrap()) && row["holds"] == true && row["meaning"] != "");
    }
    let may_fly = verdict["may_fly"].as_array().unwrap();
    assert!(may_fly.last().unwrap().as_str().unwrap().starts_with("3 m circle: "));
    assert_eq!(verdict["rotors"].as_array().unwrap().len(), 4);
    assert!(verdict["constants"].as_str().unwrap().contains("k_omega_t"));
}

#[test]
fn a_vehicle_that_may_not_fly_is_told_what_it_fails_in() {
    let slow = preset("hummingbird").replace("lag = 0.005", "lag = 1.0");
    let verdict = certify("slow.toml", &slow).unwrap();
    assert!(verdict["decision"].as_str().unwrap().starts_with("NOT certified: "), "{verdict}");
    assert!(verdict["advice"][0].as_str().unwrap().starts_with("What it fails in: "));
    assert!(verdict["loops"].as_array().unwrap().iter().any(|a_loop| a_loop["holds"] == false));
}

#[test]
fn a_bad_file_is_refused_by_file_field_and_reason() {
    let good = preset("x500");
    for (text, said) in [
        (good.replace("mass = 2.064", "mass = -1"), "bad.toml: vehicle.mass: must be "),
        (good.replace("[rotors]", "[rotor]"), "bad.toml: rotor: unknown key, did you mean \"rotors\"?"),
        ("mass".to_owned(), "bad.toml: "),
    ] {
        let error = certify("bad.toml", &text).unwrap_err();
        assert!(error.starts_with(said) && !error.contains('\n'), "{error}");
        assert_eq!(fly(&text, "step", &json!({})).unwrap_err(), error.replace("bad.toml", "mine.toml"));
    }
}

#[test]
fn files_of_other_programs_become_vehicle_files_and_say_what_they_lack() {
    let import = |file: &str, text: &str| ask(&json!({"do": "import", "file": file, "text": text}));
    let urdf = r#"<robot name="cf"><properties arm="0.0397" kf="3.16e-10" km="7.94e-12" thrust2weight="2.25"
        max_speed_kmh="30" gnd_eff_coeff="11.36859" prop_radius="2.31348e-2" drag_coeff_xy="9.1785e-7"
        drag_coeff_z="10.311e-7" dw_coeff_1="2267.18" dw_coeff_2=".16" dw_coeff_3="-.11"/>
        <link name="base_link"><inertial><origin rpy="0 0 0"
        xyz="0 0 0"/><mass value="0.027"/><inertia ixx="1.4e-5" ixy="0" ixz="0" iyy="1.4e-5" iyz="0" izz="2.17e-5"/>
        </inertial></link></robot>"#;
    let found = import("cf2x.urdf", urdf).unwrap();
    assert_eq!(found["format"], "urdf");
    let missing = found["missing"].as_array().unwrap();
    assert!(missing.contains(&json!("rotors.lag")), "{found}");
    let error = certify("cf2x.toml", found["text"].as_str().unwrap()).unwrap_err();
    assert!(error.contains("missing"), "{error}");
    let toml = import("own.toml", "anything").unwrap();
    assert_eq!((&toml["format"], &toml["text"]), (&json!("toml"), &json!("anything")));
    let error = import("letter.txt", "Dear Sir").unwrap_err();
    assert!(error.starts_with("letter.txt: is no vehicle file; expected TOML"), "{error}");
    assert!(import("broken.xml", "<robot>").unwrap_err().starts_with("broken.xml: "));
}

#[test]
fn sliders_reach_the_vehicle() {
    let (text, position) = (preset("hummingbird"), "position_error");
    let farthest = |flown: &Value| {
        let all = flown["flights"][0][position].as_array().unwrap();
        all.iter().filter_map(Value::as_f64).fold(0.0, f64::max)
    };
    let still = farthest(&fly(&text, "wind", &json!({})).unwrap());
    let windy = farthest(&fly(&text, "wind", &json!({"wind": 5.0})).unwrap());
    let heavy = farthest(&fly(&text, "wind", &json!({"mass": 1.5})).unwrap());
    let weak = farthest(&fly(&text, "wind", &json!({"weak_rotor": 1, "weak_share": 0.6})).unwrap());
    assert!(still < 1e-3 && windy > 0.01 && heavy > 0.01 && weak > 0.01, "{still} {windy} {heavy} {weak}");
    for (changes, said) in [
        (json!({"wind": 21.0}), "wind: must be from 0 to 20, found 21"),
        (json!({"mass": 0.1}), "mass: must be from 0.5 to 2, found 0.1"),
        (json!({"weak_rotor": 5}), "weak_rotor: the vehicle has 4 rotors, found 5"),
        (json!({"weak_rotor": 1, "weak_share": 0.0}), "weak_share: must be from 0.1 to 1, found 0"),
    ] {
        assert_eq!(fly(&text, "step", &changes).unwrap_err(), said);
    }
}

#[test]
fn the_circle_and_ones_own_path_are_flown_as_they_certify() {
    let text = preset("hummingbird");
    let circle = fly(&text, "circle", &json!({"laws": ["ours"]})).unwrap();
    assert!(
        circle["flights"][0]["figures"]["end_error"].as_f64().unwrap() < 0.05,
        "{}",
        circle["flights"][0]["figures"]
    );
    let path = include_str!("../../scenarios/eight.csv");
    let own = fly(&text, "own", &json!({"trajectory": path, "trajectory_file": "path.csv"})).unwrap();
    let ours = &own["flights"][0];
    assert!(ours["figures"]["end_error"].as_f64().unwrap() < 0.05, "{}", ours["figures"]);
    // The flight begins where the path does.
    assert_eq!(own["reference"][0], ours["position"][0]);
    let error = fly(&text, "own", &json!({"trajectory": "t,x\n0,a\n", "trajectory_file": "path.csv"})).unwrap_err();
    assert!(error.starts_with("path.csv: "), "{error}");
    let error = fly(&text, "own", &json!({})).unwrap_err();
    assert!(error.starts_with("trajectory: choose a file"), "{error}");
}

#[test]
fn rows_are_as_many_as_their_times_and_end_after_all_have_settled() {
    let flown = fly(&preset("hummingbird"), "upside_down", &json!({})).unwrap();
    let flights = flown["flights"].as_array().unwrap();
    assert_eq!(flights.iter().map(|flight| &flight["law"]).collect::<Vec<_>>(), ["ours", "indi"]);
    let rows = |flight: &Value, name: &str| flight[name].as_array().unwrap().len();
    for flight in flights {
        let count = rows(flight, "t");
        for name in ["position", "attitude", "position_error", "tilt", "thrust", "torque", "rotors", "cut"] {
            assert_eq!(rows(flight, name), count, "{name}");
        }
        assert!((600..3000).contains(&count), "{count}");
    }
    assert!(
        flown["bounds"]["proven"]["thrust"][1].as_f64().unwrap() <= flown["bounds"]["thrust_max"].as_f64().unwrap()
    );
    assert!(flights[1]["note"].as_str().unwrap().contains("found for this vehicle"), "{}", flights[1]["note"]);
}

#[test]
fn indi_gets_gains_also_on_a_vehicle_that_no_search_knows() {
    let text = preset("x500").replace("mass = 2.064", "mass = 1.9");
    let flown = fly(&text, "step", &json!({"laws": ["indi"]})).unwrap();
    let indi = &flown["flights"][0];
    assert!(indi["note"].as_str().unwrap().contains("tried here"), "{indi}");
    assert!(indi["figures"]["settled"].as_f64().unwrap() < 6.0, "{}", indi["figures"]);
}

#[test]
fn the_papers_flight_is_the_published_number() {
    let number = ask(&json!({"do": "paper"})).unwrap();
    assert_eq!((&number["hash"], &number["same"]), (&number["published"], &json!(true)));
}

#[test]
fn what_is_no_request_is_refused() {
    for request in ["", "{", "{\"do\": \"anything\"}", "{\"do\": \"fly\"}", "{\"do\": \"certify\", \"file\": 1}"] {
        let answer: Value = serde_json::from_str(&answer(request)).unwrap();
        assert!(answer["error"].as_str().unwrap().starts_with("request: "), "{request}: {answer}");
    }
}
