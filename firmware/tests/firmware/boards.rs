//! Requirements on the boards' sources that no test on a desk can run.

use std::path::Path;

fn read(file: &str) -> String {
    std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(file)).unwrap()
}

fn source(board: &str) -> String {
    read(&format!("src/boards/{}.rs", board.replace('-', "_")))
}

/// Features that have nothing but a chip.
fn boards() -> Vec<String> {
    let manifest = read("Cargo.toml");
    let features = manifest.lines().filter_map(|line| line.split_once(" = [\"stm32"));
    let boards = features.filter(|(_, rest)| rest.ends_with("\"]") && !rest.contains(','));
    let boards: Vec<_> = boards.map(|(name, _)| name.to_owned()).collect();
    assert!(boards.len() >= 3, "{boards:?}");
    boards
}

/// What stands between `begin` and the next `end`, for each `begin`.
fn between<'a>(text: &'a str, begin: &'a str, end: &'a str) -> impl Iterator<Item = &'a str> {
    text.split(begin).skip(1).map(move |rest| rest.split(end).next().unwrap())
}

#[test]
fn a_board_is_built_held_to_budgets_and_described() {
    let (build, budgets, run) = (read("build.rs"), read("budgets.toml"), read("../.ci/run"));
    let (page, aliases) = (read("../docs/boards.md"), read("../.cargo/config.toml"));
    let checked = between(&run, "for board in ", ";").next().unwrap().to_owned();
    for board in boards() {
        let name = board.replace('-', "_");
        assert!(build.contains(&format!("(\"{}\", ", name.to_uppercase())), "{board}: no memory file in build.rs");
        assert!(budgets.contains(&format!("[[image]]\nbin = \"{board}\"\n")), "{board}: no image in budgets.toml");
        let stacks: Vec<_> = between(&budgets, "boards = [", "]").collect();
        let bounded = stacks.iter().all(|boards| boards.contains(&format!("\"{board}\"")));
        assert!(stacks.len() == 3 && bounded, "{board}: not in every list of boards in budgets.toml");
        assert!(checked.split(' ').any(|checked| checked == board), "{board}: .ci/run does not check it");
        // The default board needs no feature.
        let flashed = read("Cargo.toml").contains(&format!("default = [\"{board}\"]"))
            || aliases.contains(&format!("--features {board} --bin {board}\""));
        assert!(flashed, "{board}: no command flashes it in .cargo/config.toml");
        let called = source(&board);
        let called = between(&called, "pub const NAME: &str = \"", "\"").next().unwrap().to_owned();
        let column = page.lines().filter(|line| line.starts_with("| | ")).all(|line| line.contains(&called));
        assert!(column, "{board}: no column for {called:?} in a table of docs/boards.md");
    }
}

#[test]
fn each_output_is_on_one_line_of_one_timer() {
    for board in boards() {
        let source = source(&board);
        let lists = between(&source, "let lines =", ";").map(|list| {
            let list = list.trim().trim_start_matches('[');
            let all = list.ends_with("].map(Some)");
            let entries = list.rsplit_once(']').unwrap().0.split(", ").map(str::trim).filter(|entry| !entry.is_empty());
            entries.map(|entry| all || entry != "None").collect::<Vec<_>>()
        });
        let lists: Vec<_> = lists.collect();
        assert!(lists.iter().all(|list| list.len() == 4), "{board}: {lists:?}");
        let timers = (0..4).map(|output| lists.iter().filter(|list| list[output]).count());
        assert_eq!(timers.collect::<Vec<_>>(), [1; 4], "{board}");
        // All of them are stopped at the end.
        let stopped = source.matches("TimGp16::from_ptr(pac::").count();
        assert_eq!(stopped, source.matches("OnTimer::new(").count(), "{board}");
    }
}

#[test]
fn what_boards_share_names_none_of_them() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/boards/stm32");
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|extension| extension == "rs") {
            let text = std::fs::read_to_string(&path).unwrap();
            assert!(boards().iter().all(|board| !text.contains(board.as_str())), "{}", path.display());
        }
    }
}

#[test]
fn a_transfer_error_is_taken_away_before_the_handler_that_panics_at_it() {
    for board in boards() {
        let source = source(&board);
        let bound: Vec<_> = source.lines().filter(|line| line.contains("dma::InterruptHandler<")).collect();
        assert!(bound.len() >= 5, "{board}");
        for line in bound {
            let channel = line.split("dma::InterruptHandler<").nth(1).and_then(|rest| rest.split('>').next()).unwrap();
            let stream = channel.replace("_CH", "_STREAM");
            let expected = format!("{stream} => Errors<{channel}>, dma::InterruptHandler<{channel}>;");
            assert_eq!(line.trim(), expected, "{board}");
        }
    }
}

#[test]
fn an_edge_is_stamped_before_the_handler_that_ends_it() {
    for board in boards() {
        let source = source(&board);
        let stamped: Vec<_> = source.split("StampedPin { pin: ExtiInput::new(p.P").skip(1).collect();
        assert!(!stamped.is_empty(), "{board}");
        // A pin's line is its number in its port, and the channel's.
        for pin in stamped {
            let number = |text: &str| text.chars().take_while(char::is_ascii_digit).collect::<String>();
            let port = number(&pin[1..]);
            let numbers = ["p.EXTI", "line: "].map(|mark| pin.split(mark).nth(1).map(number));
            assert_eq!(numbers, [Some(port.clone()), Some(port.clone())], "{board}");
            let interrupt = match port.parse::<u8>().unwrap() {
                line @ 0..5 => format!("EXTI{line}"),
                5..10 => "EXTI9_5".to_owned(),
                _ => "EXTI15_10".to_owned(),
            };
            let is_stamped = source.contains(&format!("{interrupt} => Stamps, exti::InterruptHandler<"));
            assert!(is_stamped, "{board}: {interrupt}");
        }
    }
}

#[test]
fn plls_of_the_h743_run_in_the_range_that_their_8_mhz_are_allowed_in() {
    let source = source("stm32/chip/h743");
    let factors: Vec<u32> =
        source.split("PllMul::MUL").skip(1).filter_map(|rest| rest.split(',').next()?.parse().ok()).collect();
    assert_eq!(factors.len(), 2);
    // Wide: 192 to 836 MHz, chosen above what is the medium range too.
    assert!(factors.iter().all(|factor| (421..=836).contains(&(8 * factor))), "{factors:?}");
}
