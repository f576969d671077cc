//! The controller's figures: what is measured, and how good it has to be.
//!
//! Each module measures one promise in virtual time from seeds, at a [`Size`]: small enough for
//! `cargo test`, or as promised, by
//!
//! ```text
//! cargo run --release -p wmr-tests --example figures
//! ```

pub mod accuracy;
pub mod bench;
pub mod calibration;
pub mod error_model;
pub mod headings;
pub mod limits;
pub mod pause;
pub mod scrub;
pub mod slip;
pub mod stall;
pub mod time;

/// How much is measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Size {
    /// Some seconds in a debug build.
    Test,
    /// All that is promised.
    Full,
}

impl Size {
    /// One of two numbers.
    pub fn pick(self, test: usize, full: usize) -> usize {
        match self {
            Self::Test => test,
            Self::Full => full,
        }
    }
}

/// One measured number.
#[derive(Clone, Debug, PartialEq)]
pub struct Figure {
    /// What it is.
    pub what: String,
    /// What came out.
    pub value: f64,
    /// The most that it may be; `None` where it is only stated.
    pub most: Option<f64>,
    /// Its unit.
    pub unit: &'static str,
}

impl Figure {
    /// A number with a bound.
    pub fn bounded(what: impl Into<String>, value: f64, most: f64, unit: &'static str) -> Self {
        Self { what: what.into(), value, most: Some(most), unit }
    }

    /// A number that is only stated.
    pub fn stated(what: impl Into<String>, value: f64, unit: &'static str) -> Self {
        Self { what: what.into(), value, most: None, unit }
    }

    /// Whether the bound is kept; a number that is none keeps no bound.
    pub fn is_kept(&self) -> bool {
        self.value.is_finite() && self.most.is_none_or(|most| self.value <= most)
    }
}

impl std::fmt::Display for Figure {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { what, value, most, unit } = self;
        let most = most.map_or_else(String::new, |most| format!("{most}"));
        let mark = if self.is_kept() { "" } else { "  MISSED" };
        write!(f, "{what:<66} {value:>11.5} {most:>9} {unit}{mark}")
    }
}

/// Prints a table of figures.
pub fn print(title: &str, figures: &[Figure]) {
    println!("\n{title}\n{:<66} {:>11} {:>9}", "", "measured", "at most");
    figures.iter().for_each(|figure| println!("{figure}"));
}

/// Fails with the whole table if a bound is missed.
///
/// # Panics
/// If one is.
pub fn assert_kept(figures: &[Figure]) {
    let table: Vec<_> = figures.iter().map(Figure::to_string).collect();
    assert!(figures.iter().all(Figure::is_kept), "\n{}", table.join("\n"));
}
