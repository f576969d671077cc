//! One direction of a wire in virtual time, with the faults and delays that it is given.
//!
//! ```text
//! write ─► frames ─► faults (lost, cut, damaged, doubled, late) ─► speed and latency ─► read
//! ```
//! Faults strike whole frames, that is what lies between two zeros, because that is what a session
//! has to bear; a frame that loses its closing zero runs into the next. Faults are drawn from a seed,
//! so the same run has the same faults. Probabilities are 0..=1, times are since the start.

use std::collections::VecDeque;
use std::time::Duration;

/// How often frames are damaged on a wire.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Faults {
    /// Probability that a frame vanishes.
    pub loss: f64,
    /// Probability that one to three of its bytes change, the closing zero included.
    pub corruption: f64,
    /// Probability that it arrives twice.
    pub duplication: f64,
    /// Probability that its end is cut off at a random place.
    pub truncation: f64,
    /// Probability that later frames overtake it.
    pub reordering: f64,
    /// The most frames that overtake one.
    pub depth: usize,
}

impl Faults {
    /// A wire that fails in every way at once: 10 % lost, 5 % damaged, 5 % doubled, 5 % cut off, 5 %
    /// overtaken by up to 8 others.
    pub const HARSH: Self = Self {
        loss: 0.10,
        corruption: 0.05,
        duplication: 0.05,
        truncation: 0.05,
        reordering: 0.05,
        depth: 8,
    };
}

/// What happens to one frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FrameFault {
    /// It arrives.
    None,
    /// It is lost.
    Lost,
    /// It arrives twice.
    Duplicated,
    /// It arrives after this many later ones, at least one.
    Delayed(usize),
}

/// How long bytes take.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Pace {
    /// From the last byte's departure to its arrival, at least.
    pub latency: Duration,
    /// A random delay of up to this is added; frames stay in order.
    pub jitter: Duration,
    /// Bits per second, ten to a byte; `None` sets no bound.
    pub baud: Option<u32>,
}

/// One direction of a wire.
#[derive(Clone, Debug)]
pub struct Wire {
    faults: Faults,
    pace: Pace,
    random: fastrand::Rng,
    script: VecDeque<FrameFault>,
    open: Vec<u8>,
    overtaken: Vec<(usize, Vec<u8>)>,
    flying: VecDeque<(Duration, Vec<u8>)>,
    free_from: Duration,
    last_arrival: Duration,
    carried: u64,
}

impl Default for Wire {
    /// A wire that delivers everything at once.
    fn default() -> Self {
        Self::new(Faults::default(), Pace::default(), 0)
    }
}

impl Wire {
    /// A wire with these faults and this pace; `seed` decides every fault.
    pub fn new(faults: Faults, pace: Pace, seed: u64) -> Self {
        Self {
            faults,
            pace,
            random: fastrand::Rng::with_seed(seed),
            script: VecDeque::new(),
            open: Vec::new(),
            overtaken: Vec::new(),
            flying: VecDeque::new(),
            free_from: Duration::ZERO,
            last_arrival: Duration::ZERO,
            carried: 0,
        }
    }

    /// The next frames get these faults and are not damaged otherwise; those after them are as before.
    pub fn script(&mut self, faults: impl IntoIterator<Item = FrameFault>) {
        self.script.extend(faults);
    }

    /// How many of the scripted faults are still to come.
    pub fn scripted(&self) -> usize {
        self.script.len()
    }

    /// Another wire from now on; what is on its way arrives as before.
    pub fn change(&mut self, faults: Faults, pace: Pace) {
        (self.faults, self.pace) = (faults, pace);
    }

    /// What it is like now.
    pub fn quality(&self) -> (Faults, Pace) {
        (self.faults, self.pace)
    }

    /// Bytes put on the wire so far, by its sender.
    pub fn carried(&self) -> u64 {
        self.carried
    }

    /// When the last of what is on its way arrives, since the start.
    pub fn last_arrival(&self) -> Duration {
        self.last_arrival
    }

    /// Puts `bytes` on the wire at `now`.
    ///
    /// ```
    /// use wmr_sim::wire::{Faults, Pace, Wire};
    /// use std::time::Duration;
    /// let pace = Pace { baud: Some(115_200), ..Pace::default() };
    /// let mut wire = Wire::new(Faults::default(), pace, 1);
    /// wire.write(&[7; 11], Duration::ZERO);
    /// wire.write(&[0], Duration::ZERO);
    /// // Twelve bytes of ten bits take 1.04 ms.
    /// assert_eq!(wire.read(Duration::from_micros(1041)), None);
    /// assert_eq!(wire.read(Duration::from_micros(1042)).map(|frame| frame.len()), Some(12));
    /// ```
    pub fn write(&mut self, bytes: &[u8], now: Duration) {
        self.carried += bytes.len() as u64;
        for byte in bytes {
            self.open.push(*byte);
            if *byte == 0 {
                let frame = std::mem::take(&mut self.open);
                self.send(frame, now);
            }
        }
    }

    /// The next bytes that have arrived by `now`.
    pub fn read(&mut self, now: Duration) -> Option<Vec<u8>> {
        self.flying.pop_front_if(|(arrival, _)| *arrival <= now).map(|(_, frame)| frame)
    }

    fn send(&mut self, mut frame: Vec<u8>, now: Duration) {
        let bits = 10 * frame.len() as u64;
        let duration = self.pace.baud.map_or(Duration::ZERO, |baud| {
            Duration::from_nanos(bits * 1_000_000_000 / u64::from(baud))
        });
        self.free_from = self.free_from.max(now) + duration;
        let late = self.release_overtaken();
        let fault = self.script.pop_front().unwrap_or_else(|| {
            self.damage(&mut frame);
            self.draw_fault()
        });
        match fault {
            FrameFault::None => self.launch(frame),
            FrameFault::Lost => {}
            FrameFault::Duplicated => {
                self.launch(frame.clone());
                self.launch(frame);
            }
            FrameFault::Delayed(frames) => self.overtaken.push((frames, frame)),
        }
        late.into_iter().for_each(|frame| self.launch(frame));
    }

    fn draw_fault(&mut self) -> FrameFault {
        if self.strikes(self.faults.loss) {
            FrameFault::Lost
        } else if self.strikes(self.faults.duplication) {
            FrameFault::Duplicated
        } else if self.faults.depth > 0 && self.strikes(self.faults.reordering) {
            FrameFault::Delayed(self.random.usize(1..=self.faults.depth))
        } else {
            FrameFault::None
        }
    }

    fn damage(&mut self, frame: &mut Vec<u8>) {
        if self.strikes(self.faults.truncation) {
            frame.truncate(self.random.usize(0..frame.len()));
        }
        if !frame.is_empty() && self.strikes(self.faults.corruption) {
            for _ in 0..self.random.u8(1..=3) {
                let place = self.random.usize(0..frame.len());
                frame[place] ^= self.random.u8(1..);
            }
        }
    }

    /// One more frame passes: those that have been overtaken often enough go on behind it.
    fn release_overtaken(&mut self) -> Vec<Vec<u8>> {
        self.overtaken.iter_mut().for_each(|(frames, _)| *frames -= 1);
        self.overtaken.extract_if(.., |(frames, _)| *frames == 0).map(|(_, frame)| frame).collect()
    }

    fn launch(&mut self, frame: Vec<u8>) {
        let delay = self.pace.latency + self.pace.jitter.mul_f64(self.random.f64());
        self.last_arrival = self.last_arrival.max(self.free_from + delay);
        self.flying.push_back((self.last_arrival, frame));
    }

    fn strikes(&mut self, probability: f64) -> bool {
        self.random.f64() < probability
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FRAMES: usize = 20_000;

    fn frames(faults: Faults, seed: u64) -> Vec<Vec<u8>> {
        let mut wire = Wire::new(faults, Pace::default(), seed);
        for number in 0..FRAMES {
            let [high, low] = (number as u16 | 0x8080).to_be_bytes();
            wire.write(&[high, low, 1, 2, 3, 4, 5, 0], Duration::ZERO);
        }
        std::iter::from_fn(|| wire.read(Duration::ZERO)).collect()
    }

    /// Four standard deviations of a share of a tenth among 20 000.
    const SHARE: f64 = 0.009;

    #[test]
    fn each_fault_strikes_as_often_as_it_should() {
        let none = Faults::default();
        let share = |faults| frames(faults, 3).len() as f64 / FRAMES as f64;
        assert_eq!(share(none), 1.0);
        assert!((share(Faults { loss: 0.1, ..none }) - 0.9).abs() < SHARE);
        assert!((share(Faults { duplication: 0.1, ..none }) - 1.1).abs() < SHARE);
        let whole = |faults: Faults| {
            frames(faults, 4).iter().filter(|frame| frame.ends_with(&[1, 2, 3, 4, 5, 0])).count()
        };
        let cut = FRAMES - whole(Faults { truncation: 0.1, ..none });
        assert!((cut as f64 / FRAMES as f64 - 0.1).abs() < SHARE, "{cut}");
        // A frame of eight bytes: one to three changes miss the two first with (6/8)^n.
        let seen = (1..=3).map(|n| 1.0 - 0.25f64.powi(n)).sum::<f64>() / 3.0;
        let changed = FRAMES - whole(Faults { corruption: 0.1, ..none });
        assert!((changed as f64 / FRAMES as f64 - 0.1 * seen).abs() < SHARE, "{changed}");
    }

    #[test]
    fn nothing_is_overtaken_by_more_than_it_may() {
        let faults = Faults { reordering: 0.2, depth: 8, ..Faults::default() };
        let mut wire = Wire::new(faults, Pace::default(), 5);
        for number in 1..=200u8 {
            wire.write(&[number, 0], Duration::ZERO);
        }
        let order: Vec<u8> =
            std::iter::from_fn(|| wire.read(Duration::ZERO)).map(|frame| frame[0]).collect();
        let overtakers =
            |place: usize| order[..place].iter().filter(|earlier| **earlier > order[place]).count();
        let most = (0..order.len()).map(overtakers).max();
        assert_eq!(most, Some(8));
    }

    #[test]
    fn the_same_seed_is_the_same_wire() {
        assert_eq!(frames(Faults::HARSH, 7), frames(Faults::HARSH, 7));
        assert_ne!(frames(Faults::HARSH, 7), frames(Faults::HARSH, 8));
    }

    #[test]
    fn jitter_delays_but_keeps_the_order() {
        let jitter = Duration::from_millis(2);
        let latency = Duration::from_millis(1);
        let mut wire = Wire::new(Faults::default(), Pace { latency, jitter, baud: None }, 1);
        wire.write(&[1, 0], Duration::ZERO);
        wire.write(&[2, 0], Duration::ZERO);
        assert_eq!(wire.read(latency - Duration::from_nanos(1)), None);
        let arrived: Vec<_> = std::iter::from_fn(|| wire.read(latency + jitter)).collect();
        assert_eq!(arrived, [[1, 0], [2, 0]]);
    }
}
