//! Reads tables of TOML files field by field, and says in which line what is wrong.

use std::cell::RefCell;
use std::collections::BTreeSet;
use std::ops::RangeInclusive;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// What is wrong with a file.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum FileError {
    /// It is no TOML.
    #[error("line {line}: {what}")]
    Syntax {
        /// Counted from 1.
        line: usize,
        /// What the parser says.
        what: String,
    },
    /// A value is not what belongs there.
    #[error("line {line}: {field} = {value} {why}")]
    Value {
        /// Counted from 1.
        line: usize,
        /// Its name.
        field: String,
        /// As the file has it.
        value: String,
        /// What belongs there.
        why: String,
    },
    /// A field is missing.
    #[error("line {line}: {field} is missing: {why}")]
    Missing {
        /// Where its table begins, counted from 1.
        line: usize,
        /// Its name.
        field: String,
        /// What belongs there.
        why: String,
    },
    /// A field that nobody knows.
    #[error("line {line}: there is no {field} here; there are {known}")]
    Unknown {
        /// Counted from 1.
        line: usize,
        /// Its name.
        field: String,
        /// Those that there are.
        known: String,
    },
}

/// One table of a file.
pub(crate) struct Section<'a> {
    text: &'a str,
    table: &'a DeTable<'a>,
    start: usize,
    asked: RefCell<BTreeSet<&'static str>>,
}

/// Parses a whole file.
pub(crate) fn parse(text: &str) -> Result<Spanned<DeTable<'_>>, FileError> {
    DeTable::parse(text).map_err(|error| FileError::Syntax {
        line: line_of(text, error.span().map_or(0, |span| span.start)),
        what: error.message().to_owned(),
    })
}

fn line_of(text: &str, place: usize) -> usize {
    1 + text.bytes().take(place).filter(|byte| *byte == b'\n').count()
}

impl<'a> Section<'a> {
    /// The table itself, which begins at byte `start` of `text`.
    pub(crate) fn new(text: &'a str, table: &'a DeTable<'a>, start: usize) -> Self {
        Self { text, table, start, asked: RefCell::default() }
    }

    fn get(&self, field: &'static str) -> Option<&'a Spanned<DeValue<'a>>> {
        self.asked.borrow_mut().insert(field);
        self.table.get(field)
    }

    /// Whether the field is there.
    pub(crate) fn has(&self, field: &'static str) -> bool {
        self.get(field).is_some()
    }

    /// An error about a field as it stands in the file, or about its absence.
    pub(crate) fn wrong(&self, field: &'static str, why: impl Into<String>) -> FileError {
        let why = why.into();
        match self.get(field) {
            None => FileError::Missing {
                line: line_of(self.text, self.start),
                field: field.into(),
                why,
            },
            Some(value) => self.wrong_value(field, value, why),
        }
    }

    fn wrong_value(&self, field: &str, value: &Spanned<DeValue<'_>>, why: String) -> FileError {
        let span = value.span();
        let shown = self.text.get(span.clone()).unwrap_or_default();
        FileError::Value {
            line: line_of(self.text, span.start),
            field: field.into(),
            value: shown.lines().next().unwrap_or_default().to_owned(),
            why,
        }
    }

    /// A number within `range`, if the field is there.
    pub(crate) fn number(
        &self,
        field: &'static str,
        range: RangeInclusive<f64>,
    ) -> Result<Option<f64>, FileError> {
        let Some(value) = self.get(field) else { return Ok(None) };
        let fits = number(value.get_ref()).filter(|number| range.contains(number));
        let why = || is_no_number(&range);
        fits.map(Some).ok_or_else(|| self.wrong_value(field, value, why()))
    }

    /// A number within `range`.
    pub(crate) fn needed(
        &self,
        field: &'static str,
        range: RangeInclusive<f64>,
    ) -> Result<f64, FileError> {
        let found = self.number(field, range.clone())?;
        found.ok_or_else(|| {
            self.wrong(field, format!("a number from {} to {}", range.start(), range.end()))
        })
    }

    /// `N` finite numbers, if the field is there.
    pub(crate) fn numbers<const N: usize>(
        &self,
        field: &'static str,
    ) -> Result<Option<[f64; N]>, FileError> {
        let Some(value) = self.get(field) else { return Ok(None) };
        let why = || format!("must be {N} numbers in brackets");
        numbers(value.get_ref())
            .and_then(|found| <[f64; N]>::try_from(found).ok())
            .map(Some)
            .ok_or_else(|| self.wrong_value(field, value, why()))
    }

    /// Points x, y, if the field is there.
    pub(crate) fn points(&self, field: &'static str) -> Result<Option<Vec<[f64; 2]>>, FileError> {
        let Some(value) = self.get(field) else { return Ok(None) };
        let point = |value: &Spanned<DeValue<'_>>| {
            numbers(value.get_ref()).and_then(|found| <[f64; 2]>::try_from(found).ok())
        };
        let found = value.get_ref().as_array().map(|array| array.iter().map(point).collect());
        let why = || "must be points: [[x, y], [x, y], ...]".to_owned();
        found.flatten().map(Some).ok_or_else(|| self.wrong_value(field, value, why()))
    }

    /// Text, if the field is there.
    pub(crate) fn text(&self, field: &'static str) -> Result<Option<&'a str>, FileError> {
        let Some(value) = self.get(field) else { return Ok(None) };
        let why = || "must be text in quotes".to_owned();
        let text = value.get_ref().as_str();
        text.map(Some).ok_or_else(|| self.wrong_value(field, value, why()))
    }

    /// One of `known`, if the field is there.
    pub(crate) fn choice<T: Copy>(
        &self,
        field: &'static str,
        known: &[(&str, T)],
    ) -> Result<Option<T>, FileError> {
        let Some(text) = self.text(field)? else { return Ok(None) };
        let found = known.iter().find(|(name, _)| *name == text).map(|(_, choice)| *choice);
        found.map(Some).ok_or_else(|| self.wrong(field, must_be(known)))
    }

    /// A table, if the field is there.
    pub(crate) fn section(&self, field: &'static str) -> Result<Option<Self>, FileError> {
        let Some(value) = self.get(field) else { return Ok(None) };
        let why = || format!("must be a table: [{field}]");
        let table = value.get_ref().as_table();
        let table = table.ok_or_else(|| self.wrong_value(field, value, why()))?;
        Ok(Some(Self::new(self.text, table, value.span().start)))
    }

    /// Tables, none if the field is not there.
    pub(crate) fn sections(&self, field: &'static str) -> Result<Vec<Self>, FileError> {
        let Some(value) = self.get(field) else { return Ok(Vec::new()) };
        let why = || format!("must be tables: [[{field}]]");
        let table = |value: &'a Spanned<DeValue<'a>>| {
            let table = value.get_ref().as_table()?;
            Some(Self::new(self.text, table, value.span().start))
        };
        let found = value.get_ref().as_array().map(|array| array.iter().map(table).collect());
        found.flatten().ok_or_else(|| self.wrong_value(field, value, why()))
    }

    /// An error if the table has a field that nobody has asked for.
    pub(crate) fn finish(&self) -> Result<(), FileError> {
        let asked = self.asked.borrow();
        let stray = self.table.iter().find(|(key, _)| !asked.contains(key.get_ref().as_ref()));
        stray.map_or(Ok(()), |(key, _)| {
            Err(FileError::Unknown {
                line: line_of(self.text, key.span().start),
                field: key.get_ref().to_string(),
                known: asked.iter().copied().collect::<Vec<_>>().join(", "),
            })
        })
    }
}

fn is_no_number(range: &RangeInclusive<f64>) -> String {
    format!("must be a number from {} to {}", range.start(), range.end())
}

/// `must be "a", "b" or "c"`.
pub(crate) fn must_be<T>(known: &[(&str, T)]) -> String {
    let names: Vec<String> = known.iter().map(|(name, _)| format!("\"{name}\"")).collect();
    match names.split_last() {
        Some((last, rest)) if !rest.is_empty() => {
            format!("must be {} or {last}", rest.join(", "))
        }
        _ => format!("must be {}", names.join("")),
    }
}

fn number(value: &DeValue<'_>) -> Option<f64> {
    let text = match value {
        DeValue::Integer(integer) if integer.radix() == 10 => integer.as_str(),
        DeValue::Float(float) => float.as_str(),
        _ => return None,
    };
    text.replace('_', "").parse().ok().filter(|number: &f64| number.is_finite())
}

fn numbers(value: &DeValue<'_>) -> Option<Vec<f64>> {
    value.as_array()?.iter().map(|value| number(value.get_ref())).collect()
}
