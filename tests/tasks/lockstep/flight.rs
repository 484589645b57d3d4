//! One flight: the firmware's tasks, the vehicle and the people, all on one simulated clock.

use super::simulated_hardware::{Dark, SimBattery, SimImu, SimMotors, SimWatchdog, SimulatedHardware};
use super::station::Station;
use embassy_sync::blocking_mutex::raw::CriticalSectionRawMutex;
use firmware::configuration::Pilot;
use firmware::control::Control;
use firmware::hardware::Clock;
use firmware::outputs::Outputs;
use firmware::parameters::table::Name;
use firmware::shared::{Report, Shared};
use firmware::{boot, configuration, imu, link, status};
use flight::Mode;
use futures::executor::LocalPool;
use futures::task::LocalSpawnExt;
use host_sim::sessions::sitl::clock::SimClock;
use host_sim::sessions::sitl::memory_line::MemoryLine;
use mavlink::dialects::common::MavResult;
use std::cell::Cell;
use std::rc::Rc;

/// Time between poses, us.
const POSE_PERIOD: u64 = 10_000;

/// A flight under way.
pub struct Flight {
    pool: LocalPool,
    clock: SimClock,
    pub hardware: SimulatedHardware,
    pub station: Station,
    pub shared: &'static Shared<CriticalSectionRawMutex>,
    poses: Rc<Cell<bool>>,
}

impl Flight {
    /// Boots the firmware on a vehicle that stands on the ground, with poses and heartbeats coming in.
    pub fn boot() -> Self {
        Self::boot_with(&[])
    }

    /// The same with parameters that were set before the boot.
    pub fn boot_with(parameters: &[(Name, f32)]) -> Self {
        Self::with(|shared| {
            parameters.iter().for_each(|&(name, value)| shared.parameters.set(name, value).unwrap());
            boot::start(Box::leak(Box::new(boot::Place::new())), shared.for_boot()).unwrap()
        })
    }

    /// The same with what the firmware boots with.
    pub fn with(boot: impl FnOnce(&Shared<CriticalSectionRawMutex>) -> (&'static mut Pilot, Outputs)) -> Self {
        let pool = LocalPool::new();
        let spawner = pool.spawner();
        let clock = SimClock::default();
        // As long as the program: what tasks share is static on a board as well.
        let shared: &'static Shared<CriticalSectionRawMutex> = Box::leak(Box::new(Shared::new()));
        let hardware = SimulatedHardware::new(&clock, &configuration::embedded().unwrap());
        let (up, down) = (MemoryLine::default(), MemoryLine::default());
        let station = Station::new(&clock, up.clone(), down.clone());

        let (pilot, outputs) = boot(shared);
        let period = pilot.period();
        let (vehicle, time) = (hardware.clone(), clock.clone());
        let control = async move {
            let mut control = Control::new(shared.for_control(), pilot, outputs);
            control.run(&time, &mut SimMotors(vehicle.clone()), &mut SimWatchdog(vehicle)).await;
        };
        spawner.spawn_local(control).unwrap();
        let (vehicle, time) = (hardware.clone(), clock.clone());
        spawner
            .spawn_local(async move { imu::run(shared.for_imu(), &time, &mut SimImu(vehicle), period).await })
            .unwrap();
        let time = clock.clone();
        spawner.spawn_local(async move { link::receive::receive(up, &time, shared.for_receive()).await }).unwrap();
        let time = clock.clone();
        spawner.spawn_local(async move { link::transmit::transmit(down, &time, shared.for_transmit()).await }).unwrap();

        let (vehicle, time) = (hardware.clone(), clock.clone());
        spawner
            .spawn_local(async move { status::run(Dark, SimBattery(vehicle), &time, shared.for_status()).await })
            .unwrap();

        let poses = Rc::new(Cell::new(true));
        spawner.spawn_local(hardware.clone().run()).unwrap();
        spawner.spawn_local(station.clone().run()).unwrap();
        spawner.spawn_local(send_poses(clock.clone(), hardware.clone(), station.clone(), Rc::clone(&poses))).unwrap();
        Self { pool, clock, hardware, station, shared, poses }
    }

    /// Lets time pass, s.
    pub fn pass(&mut self, seconds: f64) {
        let end = self.clock.now() + (seconds * 1e6).round() as u64;
        self.clock.run(&mut self.pool, end);
    }

    /// The time, us.
    pub fn now(&self) -> u64 {
        self.clock.now()
    }

    /// Lets poses come in, or not.
    pub fn poses(&self, on: bool) {
        self.poses.set(on);
    }

    /// The last tick's report.
    pub fn report(&self) -> Report {
        self.shared.report.get().unwrap().value
    }

    /// Boots, arms, and goes up to 1 m by a setpoint.
    pub fn in_the_air() -> Self {
        Self::in_the_air_with(&[])
    }

    /// The same with parameters that were set before the boot.
    pub fn in_the_air_with(parameters: &[(Name, f32)]) -> Self {
        let mut flight = Self::boot_with(parameters);
        flight.pass(2.0);
        flight.go_up();
        flight
    }

    /// Arms, and goes up to 1 m by a setpoint.
    pub fn go_up(&mut self) {
        self.station.arm(true);
        self.pass(0.1);
        assert_eq!(self.report().mode, Mode::Idling, "{:?}", self.station.texts());
        self.station.go_to([0.0, 0.0, 1.0]);
        self.station.fly_setpoints();
        self.pass(0.1);
        assert_eq!(self.report().mode, Mode::Flying, "{:?}", self.station.texts());
        self.pass(12.0);
    }

    /// Lets time pass until the vehicle says something that begins so; when it did, us.
    pub fn until(&mut self, words: &str, seconds: f64) -> u64 {
        let end = self.now() + (seconds * 1e6) as u64;
        loop {
            if let Some(time) = self.station.received(words) {
                return time;
            }
            assert!(self.now() < end, "not within {seconds} s: {words}: {:?}", self.station.texts());
            self.pass(0.01);
        }
    }

    /// Asks to arm and says what was answered: the acknowledgement, and what was said besides.
    pub fn ask_to_arm(&mut self) -> (Option<MavResult>, Vec<String>) {
        let before = self.station.texts().len();
        self.station.forget_acknowledgements();
        self.station.arm(true);
        self.pass(0.1);
        let texts = self.station.texts().split_off(before).into_iter().map(|(_, text)| text);
        (self.station.acknowledged(), texts.collect())
    }

    /// How far the vehicle is from a point, m.
    pub fn distance(&self, point: [f32; 3]) -> f32 {
        (self.hardware.pose().position - nalgebra::Vector3::from(point)).norm()
    }
}

async fn send_poses(clock: SimClock, hardware: SimulatedHardware, station: Station, on: Rc<Cell<bool>>) {
    loop {
        if on.get() {
            station.send(&Station::odometry(&hardware.pose()));
        }
        clock.until(clock.now() + POSE_PERIOD).await;
    }
}
