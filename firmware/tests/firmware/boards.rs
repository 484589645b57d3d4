//! Requirements on the boards' sources that no test on a desk can run.

use std::path::Path;

const BOARDS: [&str; 2] = ["crazyflie_bolt", "micoair_h743"];

fn source(board: &str) -> String {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("src/boards/{board}.rs"));
    std::fs::read_to_string(file).unwrap()
}

#[test]
fn a_transfer_error_is_taken_away_before_the_handler_that_panics_at_it() {
    for board in BOARDS {
        let source = source(board);
        let bound: Vec<_> = source.lines().filter(|line| line.contains("dma::InterruptHandler<")).collect();
        assert!(bound.len() >= 5, "{board}");
        for line in bound {
            let channel = line.split("dma::InterruptHandler<").nth(1).and_then(|rest| rest.split('>').next()).unwrap();
            let number = channel.strip_prefix("DMA1_CH").unwrap();
            let expected = format!("DMA1_STREAM{number} => Errors<{channel}>, dma::InterruptHandler<{channel}>;");
            assert_eq!(line.trim(), expected, "{board}");
        }
    }
}

#[test]
fn an_edge_is_stamped_before_the_handler_that_ends_it() {
    for board in BOARDS {
        let source = source(board);
        let bound: Vec<_> = source.lines().filter(|line| line.contains("exti::InterruptHandler<")).collect();
        assert!(!bound.is_empty(), "{board}");
        for line in bound {
            assert!(line.contains("=> Stamps, exti::InterruptHandler<"), "{board}: {line}");
        }
        // A pin's line is its number in its port, and the channel's.
        for pin in source.split("ExtiInput::new(p.P").skip(1) {
            let number = |text: &str| text.chars().take_while(char::is_ascii_digit).collect::<String>();
            let port = number(&pin[1..]);
            let numbers = ["p.EXTI", "line: "].map(|mark| pin.split(mark).nth(1).map(number));
            assert_eq!(numbers, [Some(port.clone()), Some(port)], "{board}");
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
