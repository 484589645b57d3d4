use super::*;
#[test]
fn look() {
    for file in
        ["hummingbird", "study", "published/x500", "published/pelican", "published/racer-pybullet", "published/iris"]
    {
        let text = std::fs::read_to_string(format!("../vehicles/{file}.toml")).unwrap();
        let scenario = Scenario::parse(&text, file).unwrap();
        let started = std::time::Instant::now();
        let loops = match Loops::new(&scenario, &Tolerances::USUAL, &|_| ()) {
            Ok(loops) => loops,
            Err(none) => {
                eprintln!("{file}: {none}");
                continue;
            }
        };
        eprintln!("{file} {:?}, greatest {}", started.elapsed(), loops.greatest_gust(2.0));
        for gust in [0.1, 0.2, 0.4, 0.6, 1.0, 2.0] {
            for tube in [loops.tube(gust), loops.analysed(gust)] {
                match tube {
                    Ok(tube) => eprintln!("   {gust}: {:.4?} {:.4}", tube.radii, tube.greatest()),
                    Err(none) => eprintln!("   {gust}: {none}"),
                }
            }
        }
        eprintln!("{:?}", started.elapsed());
    }
}
