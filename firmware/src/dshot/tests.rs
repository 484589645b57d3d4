use super::*;
use dshot_frame::BidirectionalFrame;

/// Ticks of a bit on the MicoAir: 200 MHz / 300 kHz.
const PERIOD_TICKS: u16 = 666;

fn values(command: MotorCommand) -> [u16; MOTOR_COUNT] {
    frames(command).unwrap().map(|frame| frame.inner() >> 5)
}

/// What a controller at the end of `channel` reads: a bit is one if it is high for more than half its time.
fn read(waveform: &Waveform<u16>, channel: usize) -> u16 {
    let rows: &[[u16; MOTOR_COUNT]] = waveform.words().as_chunks().0;
    let bit = |row: &[u16; MOTOR_COUNT]| u16::from(row[channel] > PERIOD_TICKS / 2);
    rows[..FRAME_BITS].iter().fold(0, |frame, row| frame << 1 | bit(row))
}

/// Draws a command, motor i on channel i.
fn draw(waveform: &mut Waveform<u16>, command: MotorCommand) {
    waveform.draw(&frames(command).unwrap(), Protocol::Plain, &[0, 1, 2, 3].map(Some), PERIOD_TICKS);
}

#[test]
fn stop_is_the_value_zero_with_the_checksum_zero() {
    assert_eq!(frames(MotorCommand::Stop).unwrap().map(|frame| frame.inner()), [0; MOTOR_COUNT]);
}

#[test]
fn a_motor_test_turns_one_motor_and_stops_the_others() {
    assert_eq!(values(MotorCommand::One { motor: 2, level: 0.0 }), [0, 0, 48, 0]);
    assert!(frames(MotorCommand::One { motor: 4, level: 0.1 }).is_err());
    assert!(frames(MotorCommand::One { motor: 0, level: f32::NAN }).is_err());
}

#[test]
fn words_are_settings_that_ask_for_telemetry_and_the_other_motors_stop() {
    for (word, value) in [(Word::Beep, 1), (Word::Normal, 20), (Word::Reversed, 21), (Word::Save, 12)] {
        let frames = frames(MotorCommand::Word { motor: 1, word }).unwrap().map(|frame| frame.inner());
        assert_eq!((frames[1] >> 5, frames[1] >> 4 & 1), (value, 1));
        assert_eq!([frames[0], frames[2], frames[3]], [0; 3]);
    }
    assert!(frames(MotorCommand::Word { motor: 4, word: Word::Save }).is_err());
}

#[test]
fn commands_cover_48_to_2047_and_never_the_settings_between() {
    assert_eq!(values(MotorCommand::Run([0.0, 1.0, 0.5, 0.25])), [48, 2047, 1048, 548]);
    assert_eq!(values(MotorCommand::Run([-0.0, f32::MIN_POSITIVE, 1.0 - f32::EPSILON, 1.5])), [48, 48, 2047, 2047]);
    assert_eq!(values(MotorCommand::Run([-1.0, f32::MIN, f32::MAX, 2.0])), [48, 48, 2047, 2047]);
    for step in 0..=10_000 {
        let [value, ..] = values(MotorCommand::Run([step as f32 / 10_000.0; MOTOR_COUNT]));
        assert!((48..=2047).contains(&value));
    }
}

#[test]
fn a_command_that_is_not_finite_is_a_fault_for_all_motors() {
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        for motor in 0..MOTOR_COUNT {
            let mut commands = [0.5; MOTOR_COUNT];
            commands[motor] = bad;
            assert_eq!(frames(MotorCommand::Run(commands)).err(), Some(Fault));
        }
    }
}

#[test]
fn frames_carry_value_no_telemetry_and_checksum() {
    // 1046 = 0b10000010110, telemetry 0; nibbles 1000 0010 1100, their exclusive or 0110.
    let command = (1046.0 - 48.0) / THROTTLE_STEPS;
    let [frame, ..] = frames(MotorCommand::Run([command; MOTOR_COUNT])).unwrap();
    assert_eq!(frame.inner(), 0b1000_0010_1100_0110);
}

#[test]
fn each_motors_frame_comes_out_of_its_channel() {
    let frames = frames(MotorCommand::Run([0.0, 0.3, 0.7, 1.0])).unwrap();
    let channels = [3, 2, 0, 1];
    let mut waveform = Waveform::silent();
    waveform.draw(&frames, Protocol::Plain, &channels.map(Some), PERIOD_TICKS);
    for (frame, channel) in frames.iter().zip(channels) {
        assert_eq!(read(&waveform, channel.into()), frame.inner(), "channel {channel}");
    }
}

#[test]
fn motors_on_two_timers_get_their_frames_there_and_other_channels_stay_low() {
    let frames = frames(MotorCommand::Run([0.1, 0.3, 0.7, 1.0])).unwrap();
    let wiring = [[Some(1), None, Some(2), None], [None, Some(0), None, Some(1)]];
    for channels in wiring {
        let mut waveform = Waveform::silent();
        waveform.draw(&frames, Protocol::Plain, &channels, PERIOD_TICKS);
        for channel in 0..4_u8 {
            let motor = channels.iter().position(|&on| on == Some(channel));
            let low = waveform.words().iter().skip(channel.into()).step_by(MOTOR_COUNT).all(|width| *width == 0);
            assert_eq!(low, motor.is_none(), "channel {channel}");
            let expected = motor.map_or(0, |motor| frames[motor].inner());
            assert_eq!(read(&waveform, channel.into()), expected, "channel {channel}");
        }
    }
}

#[test]
fn ones_are_high_for_three_quarters_and_zeros_for_three_eighths() {
    let mut waveform = Waveform::<u16>::silent();
    draw(&mut waveform, MotorCommand::Run([1.0; MOTOR_COUNT]));
    let first = f64::from(waveform.words()[0]) / f64::from(PERIOD_TICKS);
    assert!((first - 0.75).abs() < 0.003, "{first}");
    draw(&mut waveform, MotorCommand::Stop);
    let first = f64::from(waveform.words()[0]) / f64::from(PERIOD_TICKS);
    assert!((first - 0.375).abs() < 0.003, "{first}");
    assert!(waveform.words()[0].abs_diff(zero_width(PERIOD_TICKS)) <= 1);
}

#[test]
fn a_waveform_ends_silent_and_fills_whole_bursts() {
    let mut waveform = Waveform::<u16>::silent();
    draw(&mut waveform, MotorCommand::Run([1.0; MOTOR_COUNT]));
    let words = waveform.words();
    assert!(
        words[FRAME_BITS * MOTOR_COUNT..].iter().all(|word| *word == 0) && words.len() == WAVEFORM_ROWS * MOTOR_COUNT
    );
    assert_eq!(size_of_val(words) % 16, 0);
    assert_eq!(size_of_val(Waveform::<u32>::silent().words()) % 16, 0);
    assert_eq!(align_of::<Waveform<u16>>(), 16);
}

#[test]
fn both_ways_frames_are_those_of_a_bidirectional_controller() {
    for step in 0..2000 {
        let expected = BidirectionalFrame::new(step, false).unwrap();
        let frame = NormalFrame::new(step, false).unwrap();
        assert_eq!(Protocol::BothWays.bits(&frame), expected.inner());
        assert_eq!(Protocol::Plain.bits(&frame), frame.inner());
    }
    let mut waveform = Waveform::silent();
    let channels = [0, 1, 2, 3].map(Some);
    waveform.draw(&stop(), Protocol::BothWays, &channels, PERIOD_TICKS);
    let expected = BidirectionalFrame::command(Command::MotorStop, false).inner();
    assert_eq!(read(&waveform, 2), expected);
    assert_eq!(Protocol::BothWays.stop_bits(), expected);
    assert_eq!(Protocol::Plain.stop_bits(), NormalFrame::command(Command::MotorStop, false).inner());
}
