//! The battery through a divider, on a pin of the H743's first converter.

use crate::hardware::Battery;
use embassy_stm32::Peri;
use embassy_stm32::adc::{Adc, AdcChannel, AdcConfig, AnyAdcChannel, Averaging, Resolution, SampleTime};
use embassy_stm32::peripherals::ADC1;

/// A converter, its pin, and the divider before that.
pub struct DividedBattery {
    converter: Adc<'static, ADC1>,
    pin: AnyAdcChannel<'static, ADC1>,
    divider: f32,
}

impl DividedBattery {
    /// Volts at the pin in one count of 16 bits, the reference being the boards' 3.3 V.
    const VOLTS_PER_COUNT: f32 = 3.3 / 65535.0;

    /// A battery of `divider` times the pin's voltage.
    pub fn new(adc: Peri<'static, ADC1>, pin: impl AdcChannel<ADC1> + 'static, divider: f32) -> Self {
        let config = AdcConfig { resolution: Some(Resolution::BITS16), averaging: Some(Averaging::Samples16) };
        Self { converter: Adc::new_with_config(adc, config), pin: pin.degrade_adc(), divider }
    }
}

impl Battery for DividedBattery {
    /// Takes about 50 us: sixteen conversions of 73 cycles at no more than 32 MHz.
    async fn voltage(&mut self) -> Option<f32> {
        let counts = self.converter.blocking_read(&mut self.pin, SampleTime::CYCLES64_5);
        Some(f32::from(counts) * Self::VOLTS_PER_COUNT * self.divider)
    }
}
