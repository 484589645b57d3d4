use super::*;

const HUMMINGBIRD: &str = include_str!("../../../vehicles/hummingbird.toml");

/// The Hummingbird on another reference.
fn on(reference: &str) -> Scenario {
    let (head, _) = HUMMINGBIRD.split_once("\n[reference]").unwrap();
    Scenario::parse(&format!("{head}\n[reference]\n{reference}"), "f").unwrap()
}

fn circle(speed: f64, more: &str) -> Scenario {
    let turn = speed / 3.0;
    on(&format!(
        "kind = \"harmonic\"\ncenter = [0.0, 0.0, 2.0]\namplitude = [3.0, 3.0, 0.0]\n\
         frequency = [{turn}, {turn}, 0.0]\nphase = [0.0, -1.57079633, 0.0]\n{more}"
    ))
}

fn eight(seconds: f64) -> Scenario {
    let rows: String = (0..=100)
        .map(|i| {
            let angle = TAU * f64::from(i) / 100.0;
            format!("{},{},{},2\n", seconds * f64::from(i) / 100.0, 4.0 * angle.sin(), 2.0 * (2.0 * angle).sin())
        })
        .collect();
    on(&format!("kind = \"trajectory\"\ndata = '''\nt,x,y,z\n{rows}'''\n"))
}

#[test]
fn a_path_beyond_the_bounds_of_streams_certifies_along_itself() {
    let scenario = circle(6.5, "");
    let along = Along::judge(&scenario).unwrap();
    assert!(along.holds() && along.remedy.is_none(), "{along}");
    let taken = scenario.trajectory.bounds();
    assert!(taken.horizontal_acceleration > 4.0 * scenario.configuration.bounds().horizontal_acceleration);
    let paper = Scenario::parse(include_str!("../../../vehicles/hummingbird-paper-law.toml"), "f").unwrap();
    assert_eq!(Along::judge(&paper), None);
}

#[test]
fn a_path_as_slow_as_is_said_certifies_and_a_little_faster_it_does_not() {
    let along = Along::judge(&eight(3.0)).unwrap();
    let slower = along.remedy.and_then(|remedy| remedy.slower).expect("too fast");
    assert!(slower > 1.1 && along.at.time > 0.1 && along.at.time < 6.0, "{along}");
    assert!(along.to_string().contains(&format!("; {slower:.2} times as slowly it certifies")), "{along}");
    let at = |slower: f64| Along::judge(&eight(3.0 * slower)).unwrap();
    // The path is fitted to the rows anew: it is the same within its tolerance.
    assert!(at(1.02 * slower).holds(), "{}", at(1.02 * slower));
    assert!(!at(0.95 * slower).holds(), "{}", at(0.95 * slower));
}

#[test]
fn a_path_that_certifies_with_less_force_kept_free_says_how_much() {
    let fast = circle(8.0, "force_kept = 2.0\n");
    let remedy = Along::judge(&fast).unwrap().remedy.expect("too fast");
    let force = remedy.force_kept.expect("with less force");
    assert!(force > 0.0 && force < 2.0, "{force}");
    let with = |force: f32| Along::judge(&circle(8.0, &format!("force_kept = {force}\n"))).unwrap().holds();
    assert!(with(force - 0.01) && !with(force + 0.01), "{force}");
    let much_too_fast = Along::judge(&circle(30.0, "")).unwrap();
    assert_eq!(much_too_fast.remedy.unwrap().force_kept, None, "{much_too_fast}");
}

#[test]
fn a_harmonic_motion_is_judged_over_a_period_or_the_whole_flight() {
    let period = |frequency: [f64; 3], heading: f64| {
        let text = format!(
            "kind = \"harmonic\"\ncenter = [0.0, 0.0, 2.0]\namplitude = [1.0, 0.5, 0.0]\n\
             frequency = {frequency:?}\nheading = {{ amplitude = 0.2, frequency = {heading} }}\n"
        );
        end_us(&on(&text))
    };
    assert_eq!(period([1.0, 2.0, 7.7], 1.0), 6_283_186);
    assert_eq!(period([1.0, 1.5, 0.0], 1.0), 40_000_000);
    assert_eq!(period([0.5, 1.5, 0.0], 1.0), 12_566_371);
    assert_eq!(period([1.0, 1.0, 0.0], 0.3), 40_000_000);
    assert_eq!(end_us(&on("kind = \"hover\"\nposition = [0.0, 0.0, 1.0]\n")), 0);
}

#[test]
fn a_force_that_is_no_force_is_refused_by_name() {
    let (head, _) = HUMMINGBIRD.split_once("\n[reference]").unwrap();
    for kind in ["kind = \"hover\"\nposition = [0.0, 0.0, 1.0]", "kind = \"waypoints\"\npoints = []"] {
        let text = format!("{head}\n[reference]\n{kind}\nforce_kept = -1.0\n");
        let error = Scenario::parse(&text, "f").err().expect("refused").to_string();
        assert!(error.contains("reference."), "{error}");
    }
}
