//! Messages over a debug probe: this program's few words among those of the drivers.

// Linked for the transport that it registers.
use defmt_rtt as _;

/// Says that the program has started, and as what.
pub(crate) fn started(nonce: u32) {
    defmt::info!("wmr base {} started, nonce {=u32:08x}", env!("CARGO_PKG_VERSION"), nonce);
}

/// Says where the program has panicked.
pub(crate) fn panicked(info: &core::panic::PanicInfo) {
    defmt::error!("{}", defmt::Display2Format(info));
}
