//! Maps of ROS `map_server`: a YAML file with the scale, a picture with one pixel a cell.
//!
//! A pixel of brightness b, the mean of its colour channels from 0 to 1, is occupied with
//! p = 1 − b, or b if `negate`; above `occupied_thresh` a cell is blocked, below `free_thresh` it is
//! free. What is neither is unknown, and counts as blocked: the robot does not drive where nobody has
//! looked. A pixel that is not opaque is unknown.

use super::brightness::Brightness;
use super::{CellMap, MapError};
use serde::Deserialize;
use std::fmt;

/// A map as ROS reads it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RosMap {
    /// The text of the YAML file.
    pub yaml: String,
    /// The bytes of the PGM picture.
    pub pgm: Vec<u8>,
}

/// The head of a ROS map: what its YAML file says.
#[derive(Clone, Debug, PartialEq)]
pub struct RosHead {
    /// The picture, as the file names it: a path relative to the file's folder, or an absolute one.
    pub image: String,
    /// The side of a cell, metres.
    pub resolution: f64,
    /// Where the lower left corner of the map lies in the map frame, metres.
    pub origin: [f64; 2],
    /// Whether bright cells are the occupied ones.
    pub negate: bool,
    /// Occupied above this probability, 0 to 1.
    pub occupied_thresh: f64,
    /// Free below this probability, 0 to 1.
    pub free_thresh: f64,
}

/// Something about a map that a person should know.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MapWarning {
    /// Cells of the grey that mapping programs write for unknown are free by the map's own threshold.
    UnknownIsFree {
        /// Their share of all cells, 0 to 1.
        share: f64,
        /// The map's `free_thresh`.
        free_thresh: f64,
    },
}

impl fmt::Display for MapWarning {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self::UnknownIsFree { share, free_thresh } = self;
        write!(
            out,
            "{:.0} % of the map is unknown (grey {UNKNOWN_GREY}) and taken for free, because \
             free_thresh is {free_thresh}; free_thresh: {UNKNOWN_BLOCKED} blocks it",
            share * 100.0
        )
    }
}

/// The grey of 255 that mapping programs write for unknown cells.
const UNKNOWN_GREY: u8 = 205;
/// The threshold that those programs write beside it: just below the probability of that grey.
const UNKNOWN_BLOCKED: f64 = 0.196;
/// `occupied_thresh` where the file has none.
const OCCUPIED: f64 = 0.65;
/// Above this heading of the origin, radians, a map counts as turned: it moves no cell of a map of
/// 10 000 cells by a tenth of one.
const TURNED: f64 = 1e-5;

/// The YAML file's fields. All are kept as text: whether `0.1`, `.1` or `"0.1"`, programs that write
/// maps disagree, and an error then names the field with what it holds.
#[derive(Deserialize)]
struct Fields {
    image: Option<String>,
    resolution: Option<String>,
    origin: Option<Vec<String>>,
    negate: Option<String>,
    occupied_thresh: Option<String>,
    free_thresh: Option<String>,
    mode: Option<String>,
}

impl RosHead {
    /// Reads the text of a YAML file.
    ///
    /// # Errors
    /// [`MapError`] if the text is not YAML, a field is missing or its value makes no sense.
    ///
    /// ```
    /// let head = wmr::map::RosHead::from_yaml("{image: \"depot.pgm\", resolution: 0.05}")?;
    /// assert_eq!((head.image.as_str(), head.resolution), ("depot.pgm", 0.05));
    /// # Ok::<(), wmr::map::MapError>(())
    /// ```
    pub fn from_yaml(yaml: &str) -> Result<Self, MapError> {
        let yaml = yaml.trim_start_matches('\u{feff}');
        let fields: Fields =
            serde_saphyr::from_str(yaml).map_err(|error| MapError::Yaml(error.to_string()))?;
        let image = fields.image.filter(|image| !image.is_empty());
        let resolution = fields.resolution.ok_or(MapError::Missing("resolution"))?;
        check_mode(fields.mode)?;
        let head = Self {
            image: image.ok_or(MapError::Missing("image"))?,
            resolution: number("resolution", &resolution, "it must be metres above 0", |metres| {
                metres > 0.0 && metres.is_finite()
            })?,
            origin: fields.origin.map_or(Ok([0.0; 2]), origin)?,
            negate: fields.negate.map_or(Ok(false), negate)?,
            occupied_thresh: share("occupied_thresh", fields.occupied_thresh, OCCUPIED)?,
            free_thresh: share("free_thresh", fields.free_thresh, UNKNOWN_BLOCKED)?,
        };
        if head.free_thresh > head.occupied_thresh {
            let value = head.free_thresh.to_string();
            let need = "it must not be above occupied_thresh";
            return Err(MapError::Value { what: "free_thresh", value, need });
        }
        Ok(head)
    }

    fn is_free(&self, brightness: f32) -> bool {
        let brightness = f64::from(brightness);
        let occupied = if self.negate { brightness } else { 1.0 - brightness };
        occupied < self.free_thresh && occupied <= self.occupied_thresh
    }
}

impl CellMap {
    /// Reads a ROS map from its head and the bytes of its picture.
    ///
    /// # Errors
    /// [`MapError`] if the picture cannot be decoded.
    ///
    /// ```
    /// use wmr::map::{CellMap, RosHead};
    /// let yaml = "image: a.pgm\nresolution: 0.05\norigin: [0, 0, 0]\noccupied_thresh: 0.65\nfree_thresh: 0.196\nnegate: 0";
    /// let head = RosHead::from_yaml(yaml)?;
    /// let (map, warnings) = CellMap::from_ros(&head, b"P5 3 1 255\n\x00\xfe\xcd")?;
    /// assert_eq!(map.blocked, [true, false, true]); // occupied, free, unknown
    /// assert!(warnings.is_empty());
    /// # Ok::<(), wmr::map::MapError>(())
    /// ```
    pub fn from_ros(head: &RosHead, picture: &[u8]) -> Result<(Self, Vec<MapWarning>), MapError> {
        let Brightness { columns, rows, cells } = Brightness::decode(picture)?;
        let blocked: Vec<bool> =
            cells.iter().map(|cell| !cell.is_some_and(|b| head.is_free(b))).collect();
        let unknown = f32::from(UNKNOWN_GREY) / 255.0;
        let is_unknown = |cell: &Option<f32>| cell.is_some_and(|b| (b - unknown).abs() < 1e-4);
        let mut warnings = Vec::new();
        // A map that negates writes its unknown cells differently.
        if !head.negate && head.is_free(unknown) {
            let count = cells.iter().filter(|cell| is_unknown(cell)).count();
            if count > 0 {
                let share = count as f64 / cells.len() as f64;
                let free_thresh = head.free_thresh;
                warnings.push(MapWarning::UnknownIsFree { share, free_thresh });
            }
        }
        let RosHead { resolution, origin, .. } = *head;
        Ok((Self { columns, rows, resolution, blocked, origin }, warnings))
    }

    /// Writes the map for ROS, with a picture that will be named `image`.
    ///
    /// ```
    /// use wmr::map::{CellMap, RosHead};
    /// let map = CellMap::from_movingai("type octile\nheight 1\nwidth 2\nmap\n.@\n", 0.5)?;
    /// let ros = map.to_ros("small.pgm");
    /// let (again, _) = CellMap::from_ros(&RosHead::from_yaml(&ros.yaml)?, &ros.pgm)?;
    /// assert_eq!(again, map);
    /// # Ok::<(), wmr::map::MapError>(())
    /// ```
    pub fn to_ros(&self, image: &str) -> RosMap {
        let [x, y] = self.origin;
        // A YAML scalar in double quotes is a JSON string.
        let image = serde_json::Value::from(image);
        let yaml = format!(
            "image: {image}\nmode: trinary\nresolution: {}\norigin: [{x}, {y}, 0]\n\
             negate: 0\noccupied_thresh: {OCCUPIED}\nfree_thresh: {UNKNOWN_BLOCKED}\n",
            self.resolution
        );
        let mut pgm = format!("P5\n{} {}\n255\n", self.columns, self.rows).into_bytes();
        pgm.extend(self.blocked.iter().map(|&blocked| if blocked { 0 } else { 254 }));
        RosMap { yaml, pgm }
    }
}

fn check_mode(mode: Option<String>) -> Result<(), MapError> {
    match mode.as_deref().map(str::to_ascii_lowercase).as_deref() {
        None | Some("trinary" | "scale") => Ok(()),
        _ => {
            let need = "only `trinary` and `scale` are understood";
            Err(MapError::Value { what: "mode", value: mode.unwrap_or_default(), need })
        }
    }
}

fn negate(text: String) -> Result<bool, MapError> {
    match text.to_ascii_lowercase().as_str() {
        "0" | "false" | "no" | "off" => Ok(false),
        "1" | "true" | "yes" | "on" => Ok(true),
        _ => Err(MapError::Value { what: "negate", value: text, need: "it must be 0 or 1" }),
    }
}

/// The corner of the map; a heading that is no number, as some programs write it, is none.
fn origin(texts: Vec<String>) -> Result<[f64; 2], MapError> {
    let refused = |need| MapError::Value { what: "origin", value: texts.join(", "), need };
    let numbers: Vec<f64> = texts.iter().filter_map(|text| text.trim().parse().ok()).collect();
    match *numbers.as_slice() {
        [x, y, heading] if x.is_finite() && y.is_finite() && texts.len() == 3 => {
            if heading.abs() > TURNED {
                return Err(refused(
                    "a map that is turned in its frame is not understood; turn the picture, and make the heading 0",
                ));
            }
            Ok([x, y])
        }
        _ => Err(refused("it must be [x, y, heading], metres and radians")),
    }
}

fn share(what: &'static str, text: Option<String>, default: f64) -> Result<f64, MapError> {
    let need = "it must be a probability from 0 to 1";
    text.map_or(Ok(default), |text| number(what, &text, need, |share| (0.0..=1.0).contains(&share)))
}

fn number(
    what: &'static str,
    text: &str,
    need: &'static str,
    fits: impl Fn(f64) -> bool,
) -> Result<f64, MapError> {
    let number = text.trim().parse().ok().filter(|&number| fits(number));
    number.ok_or_else(|| MapError::Value { what, value: text.to_owned(), need })
}

#[cfg(test)]
mod tests {
    use super::*;

    const YAML: &str = "image: m.pgm\nresolution: 0.1\norigin: [2.0, 3.0, 0.0]\nnegate: 0\n\
                        occupied_thresh: 0.65\nfree_thresh: 0.196\n";

    fn head(yaml: &str) -> RosHead {
        RosHead::from_yaml(yaml).unwrap_or_else(|error| panic!("{error}:\n{yaml}"))
    }

    /// The field that the head is refused for.
    fn refused(from: &str, to: &str) -> &'static str {
        let yaml = YAML.replace(from, to);
        assert_ne!(yaml, YAML, "{from} is not in the example");
        match RosHead::from_yaml(&yaml) {
            Err(MapError::Missing(what) | MapError::Value { what, .. }) => what,
            other => panic!("{other:?}"),
        }
    }

    /// Rows c01, c07, c09 to c14, c25, c29, c30 and c31.
    #[test]
    fn yaml_is_read_as_other_programs_write_it() {
        let plain = head(YAML);
        for (from, to) in [
            ("[2.0, 3.0, 0.0]", "\n- 2.0\n- 3.0\n- 0.0"),
            ("image: m.pgm\nresolution:", "'image': 'm.pgm'\n\"resolution\":"),
            ("[2.0, 3.0, 0.0]", "[2.0, 3.0,\n  0.0]"),
            ("resolution: 0.1", "resolution: 0.1\t# metres"),
            ("resolution: 0.1", "resolution: 0.1 # resolution: 9"),
            ("image", "\u{feff}image"),
            ("image", "---\nimage"),
            ("\n", "\r\n"),
            ("image", "# image: other.pgm\nimage"),
            ("image", "description: \"image: none\"\nimage"),
            ("image: m.pgm", "image:   \"m.pgm\"   # the picture"),
            ("[2.0, 3.0, 0.0]", "[ 2.0 , 3 , -0.0 ]"),
            ("0.1\n", "1.0e-01\n"),
            ("3.0, 0.0]", "3.0, -nan]"),
        ] {
            let yaml = YAML.replace(from, to);
            assert_ne!(yaml, YAML, "{from} is not in the example");
            assert_eq!(head(&yaml), plain, "{yaml}");
        }
        let flow = "{\"image\": \"m.pgm\", \"resolution\": 0.1, \"origin\": [2, 3, 0], \"negate\": 0, \
                    \"occupied_thresh\": 0.65, \"free_thresh\": 0.196}";
        assert_eq!(head(flow), plain);
    }

    /// Rows c02 and c03.
    #[test]
    fn negate_is_understood_however_it_is_spelt_and_swaps_dark_and_light() {
        for word in ["1", "true", "True", "yes", "on", "\"1\""] {
            let head = head(&YAML.replace("negate: 0", &format!("negate: {word}")));
            let (map, _) = CellMap::from_ros(&head, b"P5 2 1 255\n\xff\x00").unwrap();
            assert_eq!(map.blocked, [true, false], "{word}");
        }
        for word in ["0", "false", "False", "no"] {
            assert!(!head(&YAML.replace("negate: 0", &format!("negate: {word}"))).negate, "{word}");
        }
        assert_eq!(refused("negate: 0", "negate: 2"), "negate");
    }

    /// Rows c05, c17, c20, c21, c21d, c23, c27 and c28.
    #[test]
    fn a_head_that_makes_no_sense_is_refused_with_the_field() {
        assert_eq!(refused("3.0, 0.0]", "3.0, 1.5708]"), "origin");
        assert_eq!(refused("3.0, 0.0]", "3.0]"), "origin");
        assert_eq!(refused("[2.0,", "[.nan,"), "origin");
        for mode in ["raw", "RAW", "trinray"] {
            assert_eq!(refused("negate: 0", &format!("mode: {mode}")), "mode");
        }
        assert_eq!(refused("resolution: 0.1", ""), "resolution");
        assert_eq!(refused("0.1\n", "0\n"), "resolution");
        assert_eq!(refused("image: m.pgm", ""), "image");
        assert_eq!(refused("0.65", "65"), "occupied_thresh");
        assert_eq!(refused("0.196", "19.6"), "free_thresh");
        assert_eq!(refused("0.196", "0.7"), "free_thresh");
        let nested =
            RosHead::from_yaml("map_server:\n  ros__parameters:\n    yaml_filename: a.yaml");
        assert!(matches!(nested, Err(MapError::Missing(_))), "{nested:?}");
        assert!(matches!(RosHead::from_yaml("["), Err(MapError::Yaml(_))));
    }

    /// Rows c17b, c21b and c21c.
    #[test]
    fn fields_that_may_be_missing_have_values() {
        let short = head("image: m.pgm\nresolution: 0.1\nmode: scale");
        assert_eq!((short.origin, short.negate), ([0.0; 2], false));
        assert_eq!((short.occupied_thresh, short.free_thresh), (OCCUPIED, UNKNOWN_BLOCKED));
    }

    /// Row c18: grey 205 is 0.19608 occupied, which lies between the two usual thresholds.
    #[test]
    fn unknown_cells_that_count_as_free_are_warned_of() {
        let picture = b"P5 4 1 255\n\xfe\xcd\x00\xfe";
        let (map, warnings) = CellMap::from_ros(&head(YAML), picture).unwrap();
        assert_eq!((map.blocked, warnings), (vec![false, true, true, false], vec![]));
        let (map, warnings) =
            CellMap::from_ros(&head(&YAML.replace("0.196", "0.25")), picture).unwrap();
        assert_eq!(map.blocked, [false, false, true, false]);
        let expected = MapWarning::UnknownIsFree { share: 0.25, free_thresh: 0.25 };
        assert_eq!(warnings, [expected]);
        assert!(expected.to_string().starts_with("25 % of the map is unknown"), "{expected}");
    }
}
