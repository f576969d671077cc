//! Moving AI `.map` files: four head lines, then one letter a cell.
//!
//! `.`, `G` and `S` are free; everything else (`@`, `O`, `T`, `W`) is blocked, water included: a
//! wheeled robot does not swim.

use super::{CellMap, MapError};
use std::fmt::Write;

impl CellMap {
    /// Reads the text of a Moving AI map whose cells are `resolution` metres wide.
    ///
    /// # Errors
    /// [`MapError`] if a head line is missing or wrong or cells are missing.
    ///
    /// ```
    /// let map = wmr::map::CellMap::from_movingai("type octile\nheight 1\nwidth 2\nmap\n.@\n", 1.0)?;
    /// assert_eq!(map.blocked, [false, true]);
    /// # Ok::<(), wmr::map::MapError>(())
    /// ```
    pub fn from_movingai(text: &str, resolution: f64) -> Result<Self, MapError> {
        let (head, body) = text.split_once("\nmap").ok_or(MapError::Missing("map"))?;
        let (columns, rows) = (field(head, "width")?, field(head, "height")?);
        let cells = body.lines().map(str::trim_end).filter(|line| !line.is_empty()).take(rows);
        let mut blocked = Vec::new();
        for line in cells {
            let row = line.chars().chain(std::iter::repeat('@')).take(columns);
            blocked.extend(row.map(|letter| !matches!(letter, '.' | 'G' | 'S')));
        }
        if blocked.len() != rows * columns {
            return Err(MapError::Cut { expected: rows * columns, found: blocked.len() });
        }
        Ok(Self { columns, rows, resolution, blocked, origin: [0.0; 3] })
    }

    /// Writes the map as the text of a Moving AI map. The example is at [`CellMap::from_scene`].
    pub fn to_movingai(&self) -> String {
        let mut text = format!("type octile\nheight {}\nwidth {}\nmap\n", self.rows, self.columns);
        for row in self.blocked.chunks(self.columns) {
            text.extend(row.iter().map(|&blocked| if blocked { '@' } else { '.' }));
            // Writing into a string cannot fail.
            let _ = writeln!(text);
        }
        text
    }
}

/// The number after `name` in the head.
fn field(head: &str, name: &'static str) -> Result<usize, MapError> {
    let mut words = head.lines().filter_map(|line| line.trim().split_once(char::is_whitespace));
    let (_, value) = words.find(|(word, _)| *word == name).ok_or(MapError::Missing(name))?;
    let need = "it must be a number of cells from 1 to 100000";
    let number = value.trim().parse().ok().filter(|number| (1..=100_000).contains(number));
    number.ok_or(MapError::Value { what: name, value: value.to_owned(), need })
}

#[cfg(test)]
mod tests {
    use super::*;

    const SMALL: &str = "type octile\nheight 2\nwidth 3\nmap\n.@T\nG.W\n";

    #[test]
    fn letters_are_told_apart() {
        let map = CellMap::from_movingai(SMALL, 1.0).unwrap();
        assert_eq!(map.blocked, [false, true, true, false, false, true]);
        assert_eq!(CellMap::from_movingai(&map.to_movingai(), 1.0), Ok(map));
        assert!(CellMap::from_movingai(&SMALL.replace('\n', "\r\n"), 1.0).is_ok());
    }

    #[test]
    fn broken_maps_say_what_is_missing() {
        assert_eq!(CellMap::from_movingai("a photo", 1.0), Err(MapError::Missing("map")));
        let cut = CellMap::from_movingai(SMALL.trim_end_matches("G.W\n"), 1.0);
        assert_eq!(cut, Err(MapError::Cut { expected: 6, found: 3 }));
        let negative = SMALL.replace("width 3", "width -3");
        assert!(matches!(CellMap::from_movingai(&negative, 1.0), Err(MapError::Value { .. })));
    }
}
