//! Moving AI `.map` files: four head lines, then one letter a cell.
//!
//! `.`, `G` and `S` are free; `@`, `O`, `T` and `W` are blocked, water included: a wheeled robot does
//! not swim. So are spaces and what a short row lacks. Any other letter is refused: a digit is ground
//! of some weight, which planning would have to know.

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
        let mut lines = text.trim_start_matches('\u{feff}').lines();
        let head: Vec<&str> = lines.by_ref().take_while(|line| !is_map_line(line)).collect();
        let mut cells = lines.map(str::trim_end).filter(|line| !line.is_empty()).peekable();
        if cells.peek().is_none() {
            return Err(MapError::Missing("map"));
        }
        let (columns, rows) = (field(&head, "width")?, field(&head, "height")?);
        let mut blocked = Vec::new();
        for (row, line) in cells.take(rows).enumerate() {
            for letter in line.chars().chain(std::iter::repeat('@')).take(columns) {
                blocked.push(match letter {
                    '.' | 'G' | 'S' => false,
                    '@' | 'O' | 'T' | 'W' | ' ' => true,
                    letter => return Err(MapError::Letter { letter, row: row + 1 }),
                });
            }
        }
        if blocked.len() != rows * columns {
            return Err(MapError::Cut { expected: rows * columns, found: blocked.len() });
        }
        Ok(Self { columns, rows, resolution, blocked, origin: [0.0; 2] })
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

fn is_map_line(line: &str) -> bool {
    line.trim().eq_ignore_ascii_case("map")
}

/// The number after `name` in the head.
fn field(head: &[&str], name: &'static str) -> Result<usize, MapError> {
    let mut words = head.iter().filter_map(|line| line.trim().split_once(char::is_whitespace));
    let line = words.find(|(word, _)| word.eq_ignore_ascii_case(name));
    let (_, value) = line.ok_or(MapError::Missing(name))?;
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
    }

    /// Rows m01 to m05, m08, m09, m11 and m12.
    #[test]
    fn heads_and_rows_are_read_as_other_programs_write_them() {
        let plain = CellMap::from_movingai(SMALL, 1.0);
        for text in [
            SMALL.replace('\n', "\r\n"),
            "type octile\nwidth 3\nheight 2\nmap\n.@T\nG.W\n".to_owned(),
            SMALL.replace("octile", "tile"),
            SMALL.replace("type octile\n", ""),
            "TYPE octile\nHEIGHT 2\nWIDTH 3\nMAP\n.@T\nG.W\n".to_owned(),
            format!("\u{feff}{SMALL}"),
            SMALL.replace('T', " ").replace('W', ""),
            SMALL.replace("height ", "height\t").replace("width ", "width\t"),
        ] {
            assert_eq!(CellMap::from_movingai(&text, 1.0), plain, "{text}");
        }
    }

    /// Row m07.
    #[test]
    fn weights_of_the_ground_are_refused_with_the_letter() {
        let error = CellMap::from_movingai(&SMALL.replace("G.W", "G1W"), 1.0);
        assert_eq!(error, Err(MapError::Letter { letter: '1', row: 2 }));
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
