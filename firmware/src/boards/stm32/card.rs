//! A microSD card on SDMMC1 in four bits, at 25 MHz.
//!
//! The driver waits for a card's answers, and for it to be done with a sector, without giving way: a card at odds with
//! itself can keep it for minutes. So its task has the thread, below everything else. What the driver does give way in
//! is bounded here.
//!
//! Its DMA does not reach the stack, which lies in the DTCM: sectors go through a buffer of their own.

use crate::hardware::{Card, Fault, SECTOR_BYTES};
use core::pin::pin;
use core::task::{Context, Poll, Waker};
use embassy_stm32::sdmmc::Sdmmc;
use embassy_stm32::sdmmc::sd::{self, Addressable, CmdBlock, DataBlock, StorageDevice};
use embassy_stm32::time::Hertz;
use embassy_time::{Duration, Instant};
use static_cell::{ConstStaticCell, StaticCell};

/// The bus's clock: what every card supports without negotiation.
const BUS_FREQUENCY: Hertz = Hertz(25_000_000);

/// The longest a transfer may take.
const TRANSFER_TIMEOUT: Duration = Duration::from_millis(1_000);

/// The longest the card may be busy in one, cycles of the bus: 0.8 s. The standard lets large cards take half a second
/// to write.
pub const BUSY_TIMEOUT_CYCLES: u32 = 20_000_000;

/// The slot.
pub struct CardSlot {
    device: StorageDevice<'static, 'static, sd::Card>,
    block: &'static mut DataBlock,
    command: &'static mut CmdBlock,
    sectors: u32,
}

impl CardSlot {
    /// A slot on these pins.
    ///
    /// # Panics
    /// The second time.
    pub fn new(sdmmc: Sdmmc<'static>) -> Self {
        static SDMMC: StaticCell<Sdmmc<'static>> = StaticCell::new();
        static BLOCK: ConstStaticCell<DataBlock> = ConstStaticCell::new(DataBlock::new());
        static COMMAND: ConstStaticCell<CmdBlock> = ConstStaticCell::new(CmdBlock::new());
        let device = StorageDevice::new_uninit_sd_card(SDMMC.init(sdmmc));
        Self { device, block: BLOCK.take(), command: COMMAND.take(), sectors: 0 }
    }
}

impl Card for CardSlot {
    fn start(&mut self) -> Result<(), Fault> {
        self.sectors = 0;
        finish(self.device.reacquire(self.command, BUS_FREQUENCY))?;
        self.sectors = u32::try_from(self.device.card().size() / SECTOR_BYTES as u64).unwrap_or(u32::MAX);
        Ok(())
    }

    fn sectors(&self) -> u32 {
        self.sectors
    }

    fn read(&mut self, sector: u32, data: &mut [u8; SECTOR_BYTES]) -> Result<(), Fault> {
        finish(self.device.read_block(sector, self.block))?;
        data.copy_from_slice(&**self.block);
        Ok(())
    }

    fn write(&mut self, sector: u32, data: &[u8; SECTOR_BYTES]) -> Result<(), Fault> {
        (**self.block).copy_from_slice(data);
        finish(self.device.write_block(sector, self.block))
    }
}

/// Polls `work` until it is done, or until [`TRANSFER_TIMEOUT`] is over. The thread has nothing else to do meanwhile.
fn finish<E>(work: impl Future<Output = Result<(), E>>) -> Result<(), Fault> {
    let mut work = pin!(work);
    let end = Instant::now() + TRANSFER_TIMEOUT;
    loop {
        match work.as_mut().poll(&mut Context::from_waker(Waker::noop())) {
            Poll::Ready(done) => return done.map_err(|_| Fault),
            Poll::Pending if Instant::now() > end => return Err(Fault),
            Poll::Pending => {}
        }
    }
}
