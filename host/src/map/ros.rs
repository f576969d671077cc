//! Maps of ROS `map_server`: a YAML file with the scale, a grey picture with one pixel a cell.
//!
//! A pixel v of 0..255 is occupied with p = (255 − v)/255, or v/255 if `negate`; above
//! `occupied_thresh` a cell is blocked, below `free_thresh` it is free. What is neither is unknown, and
//! counts as blocked: the robot does not drive where nobody has looked.

use super::{CellMap, MapError};

/// A map as ROS reads it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RosMap {
    /// The text of the YAML file.
    pub yaml: String,
    /// The bytes of the PGM picture.
    pub pgm: Vec<u8>,
}

/// The picture that a map's YAML file names, to be read from the same folder.
///
/// # Errors
/// [`MapError::Missing`] if it names none.
///
/// ```
/// assert_eq!(wmr::map::ros_image_name("image: \"depot.pgm\"\nresolution: 0.05")?, "depot.pgm");
/// # Ok::<(), wmr::map::MapError>(())
/// ```
pub fn ros_image_name(yaml: &str) -> Result<&str, MapError> {
    value(yaml, "image").ok_or(MapError::Missing("image"))
}

impl CellMap {
    /// Reads a ROS map from the text of its YAML file and the bytes of its picture (PGM or PNG).
    ///
    /// # Errors
    /// [`MapError`] if a field is missing or wrong or the picture cannot be decoded.
    ///
    /// ```
    /// use wmr::map::CellMap;
    /// let yaml = "image: a.pgm\nresolution: 0.05\norigin: [0, 0, 0]\noccupied_thresh: 0.65\nfree_thresh: 0.196\nnegate: 0";
    /// let map = CellMap::from_ros(yaml, b"P5 3 1 255\n\x00\xfe\xcd")?;
    /// assert_eq!(map.blocked, [true, false, true]); // occupied, free, unknown
    /// # Ok::<(), wmr::map::MapError>(())
    /// ```
    pub fn from_ros(yaml: &str, picture: &[u8]) -> Result<Self, MapError> {
        let resolution = number(yaml, "resolution", None)?;
        if !(resolution > 0.0 && resolution.is_finite()) {
            let value = resolution.to_string();
            return Err(MapError::Value {
                what: "resolution",
                value,
                need: "it must be metres above 0",
            });
        }
        if value(yaml, "mode") == Some("raw") {
            let need = "only `trinary` and `scale` are understood";
            return Err(MapError::Value { what: "mode", value: "raw".to_owned(), need });
        }
        let negate = matches!(value(yaml, "negate"), Some("1" | "true"));
        let free_thresh = number(yaml, "free_thresh", Some(0.25))?;
        let (columns, rows, pixels) = decode(picture)?;
        let is_free = |&pixel: &u8| {
            let dark = if negate { pixel } else { 255 - pixel };
            f64::from(dark) / 255.0 < free_thresh
        };
        let blocked = pixels.iter().map(|pixel| !is_free(pixel)).collect();
        Ok(Self { columns, rows, resolution, blocked, origin: origin(yaml)? })
    }

    /// Writes the map for ROS, with a picture that will be named `image`.
    ///
    /// ```
    /// use wmr::map::CellMap;
    /// let map = CellMap::from_movingai("type octile\nheight 1\nwidth 2\nmap\n.@\n", 0.5)?;
    /// let ros = map.to_ros("small.pgm");
    /// assert_eq!(CellMap::from_ros(&ros.yaml, &ros.pgm)?, map);
    /// # Ok::<(), wmr::map::MapError>(())
    /// ```
    pub fn to_ros(&self, image: &str) -> RosMap {
        let [x, y, heading] = self.origin;
        let yaml = format!(
            "image: {image}\nmode: trinary\nresolution: {}\norigin: [{x}, {y}, {heading}]\n\
             negate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n",
            self.resolution
        );
        let mut pgm = format!("P5\n{} {}\n255\n", self.columns, self.rows).into_bytes();
        pgm.extend(self.blocked.iter().map(|&blocked| if blocked { 0 } else { 254 }));
        RosMap { yaml, pgm }
    }
}

/// The text after `key:` without quotes and comment.
fn value<'a>(yaml: &'a str, key: &str) -> Option<&'a str> {
    let mut fields = yaml.lines().filter_map(|line| line.split_once(':'));
    let (_, value) = fields.find(|(name, _)| name.trim() == key)?;
    let value = value.split(" #").next()?.trim();
    Some(value.trim_matches(['"', '\'']))
}

fn number(yaml: &str, key: &'static str, default: Option<f64>) -> Result<f64, MapError> {
    let Some(text) = value(yaml, key) else { return default.ok_or(MapError::Missing(key)) };
    let need = "it must be a number";
    text.parse().map_err(|_| MapError::Value { what: key, value: text.to_owned(), need })
}

fn origin(yaml: &str) -> Result<[f64; 3], MapError> {
    let text = value(yaml, "origin").unwrap_or("[0, 0, 0]");
    let numbers: Vec<f64> =
        text.trim_matches(['[', ']']).split(',').filter_map(|n| n.trim().parse().ok()).collect();
    let need = "it must be [x, y, heading]";
    numbers.try_into().map_err(|_| MapError::Value { what: "origin", value: text.to_owned(), need })
}

/// Columns, rows and grey pixels of 0..=255.
fn decode(picture: &[u8]) -> Result<(usize, usize, Vec<u8>), MapError> {
    match picture.get(..2) {
        Some(b"P5" | b"P2") => decode_pgm(picture),
        _ => {
            let grey = image::load_from_memory(picture)
                .map_err(|error| MapError::Picture(error.to_string()))?
                .into_luma8();
            Ok((grey.width() as usize, grey.height() as usize, grey.into_raw()))
        }
    }
}

fn decode_pgm(picture: &[u8]) -> Result<(usize, usize, Vec<u8>), MapError> {
    let mut rest = &picture[2..];
    let mut head = [0_usize; 3];
    for number in &mut head {
        *number = next_number(&mut rest).ok_or(MapError::Missing("PGM head"))?;
    }
    let [columns, rows, white] = head;
    let expected = columns.checked_mul(rows).filter(|&cells| cells <= 1 << 30);
    let expected =
        expected.ok_or_else(|| MapError::Picture(format!("{columns} × {rows} pixels")))?;
    if !(1..=255).contains(&white) {
        return Err(MapError::Picture(format!("white is {white}, not 1 to 255")));
    }
    let raw: Vec<usize> = if picture[1] == b'5' {
        rest.get(1..)
            .unwrap_or_default()
            .iter()
            .map(|&byte| usize::from(byte))
            .take(expected)
            .collect()
    } else {
        std::iter::from_fn(|| next_number(&mut rest)).take(expected).collect()
    };
    if raw.len() != expected {
        return Err(MapError::Cut { expected, found: raw.len() });
    }
    let grey = raw.into_iter().map(|value| (value.min(white) * 255 / white) as u8).collect();
    Ok((columns, rows, grey))
}

/// The next number of a PGM head, after white space and comments.
fn next_number(rest: &mut &[u8]) -> Option<usize> {
    loop {
        let skip = rest.iter().take_while(|byte| byte.is_ascii_whitespace()).count();
        *rest = &rest[skip..];
        if rest.first() != Some(&b'#') {
            break;
        }
        let line = rest.iter().take_while(|&&byte| byte != b'\n').count();
        *rest = &rest[line..];
    }
    let digits = rest.iter().take_while(|byte| byte.is_ascii_digit()).count();
    let (number, after) = rest.split_at(digits);
    *rest = after;
    std::str::from_utf8(number).ok()?.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    const YAML: &str =
        "image: 'm.pgm' # a comment\nresolution: 0.1\norigin: [2.0, 3.0, 1.0]\nnegate: 0";

    #[test]
    fn fields_are_read_whatever_their_quotes_and_comments() {
        assert_eq!(ros_image_name(YAML), Ok("m.pgm"));
        let map = CellMap::from_ros(YAML, b"P2\n# made by hand\n2 1\n100\n100 0\n").unwrap();
        assert_eq!((map.resolution, map.origin), (0.1, [2.0, 3.0, 1.0]));
        assert_eq!(map.blocked, [false, true]);
    }

    #[test]
    fn negate_swaps_dark_and_light() {
        let yaml = YAML.replace("negate: 0", "negate: 1");
        let map = CellMap::from_ros(&yaml, b"P5 2 1 255\n\xff\x00").unwrap();
        assert_eq!(map.blocked, [true, false]);
    }

    #[test]
    fn broken_maps_are_refused_with_a_reason() {
        let cut = CellMap::from_ros(YAML, b"P5 2 2 255\n\xff");
        assert_eq!(cut, Err(MapError::Cut { expected: 4, found: 1 }));
        assert!(matches!(CellMap::from_ros(YAML, b"text"), Err(MapError::Picture(_))));
        assert!(matches!(CellMap::from_ros(YAML, b"P5 2"), Err(MapError::Missing(_))));
        assert_eq!(CellMap::from_ros("image: a", b""), Err(MapError::Missing("resolution")));
        let endless = CellMap::from_ros("resolution: 0\nimage: a", b"P5 1 1 255\n\xff");
        assert!(matches!(endless, Err(MapError::Value { what: "resolution", .. })));
    }
}
