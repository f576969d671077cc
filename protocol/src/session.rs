//! The rules of one session, the same at both ends: what is sent again, what is delivered, and when.
//!
//! ```text
//! send ─► window ─► poll ═frames═► accept ─► early ─► next
//!            ▲                        │
//!            └────── ack, ack_bits ◄──┘
//! ```
//! Messages on the reliable lane are numbered. The receiver keeps up to [`WINDOW`] that came early
//! and hands them out in order; it acknowledges only what was handed out, so the sender's window is
//! also the receiver's credit. The sender repeats what is not acknowledged within a time measured
//! from the round trip. Time is an argument.

use crate::frame::{self, FrameError, Header};
use crate::units::Milliseconds;
use heapless::Deque;
use serde::Serialize;

/// The most messages of the reliable lane under way at once.
pub const WINDOW: usize = 8;

const FIRST_TIMEOUT: u32 = 100;
const SHORTEST_TIMEOUT: u32 = 20;
const LONGEST_TIMEOUT: u32 = 1000;
/// How often the timeout doubles while frames arrive, and while none does.
const LIVE_DOUBLINGS: u8 = 1;
const SILENT_DOUBLINGS: u8 = 6;

/// The name of the session between a host and a robot that said these nonces; never 0.
pub fn session_id(host_nonce: u32, robot_nonce: u32) -> u32 {
    // An odd factor keeps the two nonces from cancelling out when they are equal.
    (host_nonce.wrapping_mul(0x9E37_79B1) ^ robot_nonce).max(1)
}

/// The window is full: the other end has not yet handled earlier messages.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WindowFull;

/// One end of a session that sends `Tx` and receives `Rx`.
#[derive(Clone, Debug)]
pub struct Session<Tx, Rx> {
    id: u32,
    window: Deque<Outgoing<Tx>, WINDOW>,
    next_sequence: u16,
    early: [Option<Rx>; WINDOW],
    expected: u16,
    ack_due: bool,
    heard: Milliseconds,
    round_trip: RoundTrip,
    counters: Counters,
}

/// What a session has sent.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counters {
    /// Frames of all kinds.
    pub frames: u32,
    /// Messages of the reliable lane that were sent again.
    pub retransmitted: u32,
}

#[derive(Clone, Debug)]
struct Outgoing<Tx> {
    message: Tx,
    sequence: u16,
    arrived: bool,
    first_sent: Option<Milliseconds>,
    sent: Option<Milliseconds>,
    tries: u8,
}

impl<Tx: Serialize + Copy, Rx: Copy> Session<Tx, Rx> {
    /// A session that begins `now`.
    pub fn new(id: u32, now: Milliseconds) -> Self {
        Self {
            id,
            window: Deque::new(),
            next_sequence: 0,
            early: [None; WINDOW],
            expected: 0,
            ack_due: false,
            heard: now,
            round_trip: RoundTrip::default(),
            counters: Counters::default(),
        }
    }

    /// The session's name.
    pub fn id(&self) -> u32 {
        self.id
    }

    /// How long nothing valid has arrived, milliseconds.
    pub fn silence(&self, now: Milliseconds) -> u32 {
        now.since(self.heard)
    }

    /// What has been sent so far.
    pub fn counters(&self) -> Counters {
        self.counters
    }

    /// Whether something arrived that the other end does not yet know of.
    pub fn ack_due(&self) -> bool {
        self.ack_due
    }

    /// How many more messages the window takes.
    pub fn room(&self) -> usize {
        WINDOW - self.window.len()
    }

    /// How long the oldest message has been waiting to be handled at the other end, milliseconds.
    pub fn oldest_wait(&self, now: Milliseconds) -> u32 {
        let first_sent = self.window.front().and_then(|slot| slot.first_sent);
        first_sent.map_or(0, |sent| now.since(sent))
    }

    /// Puts a message on the reliable lane.
    ///
    /// # Errors
    /// [`WindowFull`] if [`WINDOW`] messages are under way; try again after the next ack.
    pub fn send(&mut self, message: Tx) -> Result<(), WindowFull> {
        let sequence = self.next_sequence;
        let slot =
            Outgoing { message, sequence, arrived: false, first_sent: None, sent: None, tries: 0 };
        self.window.push_back(slot).map_err(|_| WindowFull)?;
        self.next_sequence = sequence.wrapping_add(1);
        Ok(())
    }

    /// Takes in a frame of this session that arrived `now`.
    pub fn accept(&mut self, header: &Header, message: Rx, now: Milliseconds) {
        self.heard = now;
        self.acknowledge(header, now);
        let Some(sequence) = header.sequence else { return };
        self.ack_due = true;
        let ahead = sequence.wrapping_sub(self.expected);
        if usize::from(ahead) < WINDOW
            && let Some(place) = self.early.get_mut(usize::from(sequence) % WINDOW)
        {
            *place = Some(message);
        }
    }

    /// The next message of the reliable lane, each once and in order.
    pub fn next_message(&mut self) -> Option<Rx> {
        let message = self.early.get_mut(usize::from(self.expected) % WINDOW)?.take()?;
        self.expected = self.expected.wrapping_add(1);
        self.ack_due = true;
        Some(message)
    }

    /// Writes the next frame of the reliable lane that is due `now`; 0 if none is.
    pub fn poll(&mut self, now: Milliseconds, out: &mut [u8]) -> usize {
        let timeout = self.round_trip.timeout();
        let gap = self.round_trip.gap_timeout();
        let last_arrived =
            self.window.iter().filter(|slot| slot.arrived).map(|slot| slot.sequence).last();
        let base = self.window.front().map_or(0, |slot| slot.sequence);
        let heard = self.heard;
        let due = self.window.iter_mut().find(|slot| {
            let behind = last_arrived
                .is_some_and(|last| slot.sequence.wrapping_sub(base) < last.wrapping_sub(base));
            !slot.arrived && slot.is_due(now, if behind { gap } else { timeout }, heard)
        });
        let Some(slot) = due else { return 0 };
        slot.sent = Some(now);
        slot.first_sent.get_or_insert(now);
        slot.tries = slot.tries.saturating_add(1);
        let (message, sequence, again) = (slot.message, slot.sequence, slot.tries > 1);
        self.counters.retransmitted += u32::from(again);
        self.write(Some(sequence), &message, out)
    }

    /// Writes a frame of the unreliable lane; it also carries the acknowledgements.
    pub fn write_unreliable(&mut self, message: &Tx, out: &mut [u8]) -> usize {
        self.write(None, message, out)
    }

    fn write(&mut self, sequence: Option<u16>, message: &Tx, out: &mut [u8]) -> usize {
        let header =
            Header { session: self.id, sequence, ack: self.expected, ack_bits: self.ack_bits() };
        match frame::encode(&header, message, out) {
            Ok(length) => {
                self.ack_due = false;
                self.counters.frames += 1;
                length
            }
            Err(
                FrameError::TooLong
                | FrameError::Broken
                | FrameError::Damaged
                | FrameError::Unknown,
            ) => 0,
        }
    }

    fn ack_bits(&self) -> u8 {
        (0..WINDOW).fold(0, |bits, ahead| {
            let place = (usize::from(self.expected) + ahead) % WINDOW;
            let here = self.early.get(place).is_some_and(Option::is_some);
            bits | (u8::from(here) << ahead)
        })
    }

    fn acknowledge(&mut self, header: &Header, now: Milliseconds) {
        let Some(first) = self.window.front().map(|slot| slot.sequence) else { return };
        let handled = header.ack.wrapping_sub(first);
        if usize::from(handled) > self.window.len() {
            // An old frame that was overtaken: its news is known already.
            return;
        }
        for slot in &mut self.window {
            let ahead = slot.sequence.wrapping_sub(header.ack);
            let before = slot.sequence.wrapping_sub(first) < handled;
            let bit = usize::from(ahead) < WINDOW && header.ack_bits >> ahead & 1 == 1;
            if !slot.arrived && (before || bit) {
                slot.arrived = true;
                if let (Some(sent), 1) = (slot.sent, slot.tries) {
                    self.round_trip.measure(now.since(sent));
                }
            }
        }
        for _ in 0..handled {
            self.window.pop_front();
        }
    }
}

impl<Tx> Outgoing<Tx> {
    /// Each repetition waits twice as long as the last, in case the wire is slower than was measured.
    /// On a wire that brings other frames the reason is loss, which waiting does not cure.
    fn is_due(&self, now: Milliseconds, timeout: u32, heard: Milliseconds) -> bool {
        let Some(sent) = self.sent else { return true };
        let wire_lives = heard.since(sent) <= now.since(sent);
        let doublings = if wire_lives { LIVE_DOUBLINGS } else { SILENT_DOUBLINGS };
        let backed_off = timeout << self.tries.saturating_sub(1).min(doublings);
        now.since(sent) >= backed_off.min(LONGEST_TIMEOUT)
    }
}

/// The round trip as RFC 6298 smooths it, in eighths of a millisecond.
#[derive(Clone, Copy, Debug, Default)]
struct RoundTrip {
    smoothed: Option<u32>,
    variation: u32,
}

impl RoundTrip {
    fn measure(&mut self, milliseconds: u32) {
        let sample = milliseconds.min(LONGEST_TIMEOUT) * 8;
        match self.smoothed {
            None => {
                self.smoothed = Some(sample);
                self.variation = sample / 2;
            }
            Some(smoothed) => {
                self.variation = (3 * self.variation + smoothed.abs_diff(sample)) / 4;
                self.smoothed = Some((7 * smoothed + sample) / 8);
            }
        }
    }

    fn timeout(&self) -> u32 {
        let Some(smoothed) = self.smoothed else { return FIRST_TIMEOUT };
        ((smoothed + 4 * self.variation) / 8).clamp(SHORTEST_TIMEOUT, LONGEST_TIMEOUT)
    }

    /// A message is missing while a later one has arrived: one round trip is long enough to wait.
    fn gap_timeout(&self) -> u32 {
        let Some(smoothed) = self.smoothed else { return FIRST_TIMEOUT };
        (smoothed / 8).clamp(SHORTEST_TIMEOUT, LONGEST_TIMEOUT)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::{Decoder, MAX_FRAME};
    use proptest::prelude::*;

    type End = Session<u32, u32>;

    fn pair() -> (End, End) {
        (End::new(7, Milliseconds(0)), End::new(7, Milliseconds(0)))
    }

    fn deliver(bytes: &[u8], to: &mut End, now: Milliseconds) {
        let mut decoder = Decoder::default();
        for byte in bytes {
            if let Some(Ok((header, message))) = decoder.push::<u32>(*byte) {
                to.accept(&header, message, now);
            }
        }
    }

    #[test]
    fn a_message_is_delivered_once_however_often_it_arrives() {
        let (mut a, mut b) = pair();
        let mut wire = [0; MAX_FRAME];
        a.send(5).unwrap();
        let length = a.poll(Milliseconds(0), &mut wire);
        deliver(&wire[..length], &mut b, Milliseconds(1));
        deliver(&wire[..length], &mut b, Milliseconds(2));
        assert_eq!(b.next_message(), Some(5));
        deliver(&wire[..length], &mut b, Milliseconds(3));
        assert_eq!(b.next_message(), None);
    }

    #[test]
    fn nothing_is_sent_again_before_its_time() {
        let (mut a, _) = pair();
        let mut wire = [0; MAX_FRAME];
        a.send(5).unwrap();
        assert!(a.poll(Milliseconds(0), &mut wire) > 0);
        assert_eq!(a.poll(Milliseconds(99), &mut wire), 0);
        assert!(a.poll(Milliseconds(100), &mut wire) > 0);
        assert_eq!(a.counters(), Counters { frames: 2, retransmitted: 1 });
    }

    #[test]
    fn the_window_is_the_receivers_credit() {
        let (mut a, mut b) = pair();
        let mut wire = [0; MAX_FRAME];
        (0..8).for_each(|message| a.send(message).unwrap());
        assert_eq!(a.send(8), Err(WindowFull));
        for _ in 0..8 {
            let length = a.poll(Milliseconds(0), &mut wire);
            deliver(&wire[..length], &mut b, Milliseconds(0));
        }
        let length = b.write_unreliable(&0, &mut wire);
        deliver(&wire[..length], &mut a, Milliseconds(1));
        assert_eq!(a.room(), 0, "arrived, but not yet handled");
        assert_eq!(a.poll(Milliseconds(5000), &mut wire), 0, "what has arrived is not sent again");
        while b.next_message().is_some() {}
        let length = b.write_unreliable(&0, &mut wire);
        deliver(&wire[..length], &mut a, Milliseconds(2));
        assert_eq!(a.room(), WINDOW);
    }

    proptest! {
        /// One bit of `fates` per frame decides whether it is lost; another whether it comes twice.
        #[test]
        fn a_bad_wire_loses_doubles_and_reorders_nothing(fates in prop::collection::vec(0u8..8, 50..400)) {
            let (mut a, mut b) = pair();
            let mut fates = fates.into_iter().cycle();
            let (mut sent, mut received, mut late) = (0, Vec::new(), Vec::new());
            for now in (0..400_000).step_by(5).map(Milliseconds) {
                while sent < 40 && a.send(sent).is_ok() {
                    sent += 1;
                }
                let mut wire = [0; MAX_FRAME];
                let length = a.poll(now, &mut wire);
                match fates.next() {
                    Some(0 | 1) => {}
                    Some(2) => late.extend_from_slice(&wire[..length]),
                    _ => {
                        deliver(&wire[..length], &mut b, now);
                        deliver(&core::mem::take(&mut late), &mut b, now);
                    }
                }
                while let Some(message) = b.next_message() {
                    received.push(message);
                }
                let length = b.write_unreliable(&0, &mut wire);
                if fates.next() != Some(0) {
                    deliver(&wire[..length], &mut a, now);
                }
                if received.len() == 40 {
                    break;
                }
            }
            prop_assert_eq!(received, (0..40).collect::<Vec<_>>());
        }
    }
}
