//! The dictionaries: which pattern of cells is which tag.
//!
//! A tag has `side` × `side` cells of bits inside a ring of black cells. A code lists its bits row by row
//! from the top left, the first bit the highest, white 1. The codes are those of OpenCV's `aruco` module
//! (Apache-2.0): DICT_4X4_1000 to 7X7_1000, of which the smaller ones are the first 50, 100 and 250,
//! DICT_ARUCO_ORIGINAL and DICT_ARUCO_MIP_36h12; the families 36h11, 25h9 and 16h5 are AprilTag's
//! (BSD-2-Clause) in OpenCV's orientation. `codes.bin` holds them one after another in the order of
//! `TABLES`, each in as few big-endian bytes as its bits need, written from
//! `cv2.aruco.getPredefinedDictionary(…).bytesList`.

static CODES: &[u8] = include_bytes!("codes.bin");

/// One family of codes.
#[derive(Debug, PartialEq, Eq)]
struct Table {
    name: &'static str,
    side: usize,
    count: usize,
    offset: usize,
    /// Wrong bits that are forgiven: well below half the least distance between two codes.
    errors: u32,
    /// Whether smaller dictionaries are its first tags, named by their number.
    by_size: bool,
    usual: bool,
}

const fn table(
    name: &'static str,
    [side, count, offset]: [usize; 3],
    errors: u32,
    by_size: bool,
    usual: bool,
) -> Table {
    Table { name, side, count, offset, errors, by_size, usual }
}

static TABLES: [Table; 9] = [
    table("4X4", [4, 1000, 0], 0, true, true),
    table("5X5", [5, 1000, 2000], 1, true, true),
    table("6X6", [6, 1000, 6000], 2, true, true),
    table("7X7", [7, 1000, 11000], 3, true, true),
    table("ARUCO_ORIGINAL", [5, 1024, 18000], 0, false, true),
    table("ARUCO_MIP_36h12", [6, 250, 22096], 3, false, true),
    table("APRILTAG_36h11", [6, 587, 23346], 3, false, true),
    table("APRILTAG_25h9", [5, 35, 26281], 2, false, true),
    table("APRILTAG_16h5", [4, 30, 26421], 0, false, false),
];

/// A set of tags that are told apart by their patterns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TagDictionary {
    table: &'static Table,
    count: usize,
}

impl TagDictionary {
    /// The dictionaries that are looked for if none is named: all but AprilTag's 16h5, whose 30 codes of 16
    /// bits are also seen where there is no tag.
    pub fn usual() -> Vec<Self> {
        TABLES.iter().filter(|table| table.usual).map(Self::whole).collect()
    }

    /// The dictionary of a name as OpenCV writes it, in any case, with or without `DICT_`; also `36h11`,
    /// `tag36h11`.
    ///
    /// ```
    /// use wmr::vision::TagDictionary;
    /// let small = TagDictionary::named("DICT_4X4_50").unwrap();
    /// assert_eq!((small.len(), small.name()), (50, "DICT_4X4_50".into()));
    /// assert_eq!(TagDictionary::named("tag36h11"), TagDictionary::named("APRILTAG_36H11"));
    /// assert!(TagDictionary::named("4X4_60").is_none());
    /// ```
    pub fn named(name: &str) -> Option<Self> {
        let name = name.to_ascii_uppercase();
        let name = name.strip_prefix("DICT_").unwrap_or(&name);
        let plain = |full: &str| {
            let full = full.to_ascii_uppercase();
            let short = full.rsplit('_').next().unwrap_or_default();
            name == full || name == short || name.strip_prefix("TAG") == Some(short)
        };
        TABLES.iter().find_map(|table| {
            if !table.by_size {
                return plain(table.name).then(|| Self::whole(table));
            }
            let size = name.strip_prefix(table.name)?.strip_prefix('_')?;
            let count = [50, 100, 250, 1000].into_iter().find(|count| size == count.to_string())?;
            Some(Self { table, count })
        })
    }

    fn whole(table: &'static Table) -> Self {
        Self { table, count: table.count }
    }

    /// OpenCV's name.
    pub fn name(&self) -> String {
        match self.table.by_size {
            true => format!("DICT_{}_{}", self.table.name, self.count),
            false => format!("DICT_{}", self.table.name),
        }
    }

    /// How many tags it has; their ids are 0 to `len` − 1.
    pub fn len(&self) -> usize {
        self.count
    }

    /// Whether it has none: never.
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// Cells of bits along a side; the black ring comes on top.
    pub fn side(&self) -> usize {
        self.table.side
    }

    /// The cells of a tag with its black ring, row by row from the top left, `true` white; `None` if there
    /// is no such id.
    pub fn cells(&self, id: usize) -> Option<Vec<bool>> {
        let code = (id < self.count).then(|| self.code(id))?;
        let side = self.table.side;
        let cell = |index: usize| {
            let (row, column) = (index / (side + 2), index % (side + 2));
            let inside = (1..=side).contains(&row) && (1..=side).contains(&column);
            inside && code >> (side * side - 1 - ((row - 1) * side + column - 1)) & 1 == 1
        };
        Some((0..(side + 2).pow(2)).map(cell).collect())
    }

    fn code(&self, id: usize) -> u64 {
        let bytes = self.table.side.pow(2).div_ceil(8);
        let first = self.table.offset + bytes * id;
        CODES[first..first + bytes].iter().fold(0, |code, &byte| code << 8 | u64::from(byte))
    }

    /// The tag whose pattern, turned by quarters clockwise, is nearest to bits that were read: wrong bits, id
    /// and number of quarters; `None` above the errors that are forgiven.
    pub(super) fn nearest(&self, bits: u64) -> Option<(u32, usize, usize)> {
        let mut turned = [bits; 4];
        for quarter in 1..4 {
            turned[quarter] = turned_back(turned[quarter - 1], self.table.side);
        }
        let mut best = None;
        let mut least = self.table.errors + 1;
        for id in 0..self.count {
            let code = self.code(id);
            for (quarters, seen) in turned.iter().enumerate() {
                let errors = (seen ^ code).count_ones();
                if errors < least {
                    (least, best) = (errors, Some((errors, id, quarters)));
                }
            }
        }
        best
    }
}

/// The bits of a square pattern turned by a quarter counter-clockwise.
fn turned_back(bits: u64, side: usize) -> u64 {
    let at = |row: usize, column: usize| bits >> (side * side - 1 - (row * side + column)) & 1;
    (0..side * side).fold(0, |turned, index| {
        let (row, column) = (index / side, index % side);
        turned << 1 | at(column, side - 1 - row)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_tag_of_4x4_is_opencvs() {
        let rows = ["......", ".#.##.", "..#.#.", "...##.", "...#..", "......"];
        let cells = TagDictionary::named("4x4_50").unwrap().cells(0).unwrap();
        let drawn: Vec<bool> = rows.iter().flat_map(|row| row.chars()).map(|c| c == '#').collect();
        assert_eq!(cells, drawn);
    }

    /// Codes of one table differ by more than twice the errors that are forgiven, however they are turned;
    /// the original ArUco codes are the known exception, and none of theirs are forgiven.
    #[test]
    fn no_code_is_taken_for_another() {
        for table in TABLES.iter().filter(|table| table.name != "ARUCO_ORIGINAL") {
            let all = TagDictionary::whole(table);
            let codes: Vec<u64> = (0..all.len()).map(|id| all.code(id)).collect();
            let mut turned = codes.clone();
            for quarter in 0..4 {
                for (id, a) in turned.iter().enumerate() {
                    for (other, b) in codes.iter().enumerate() {
                        let same = id == other && quarter == 0;
                        assert!(same || (a ^ b).count_ones() > 2 * table.errors, "{}", table.name);
                    }
                }
                turned.iter_mut().for_each(|code| *code = turned_back(*code, table.side));
            }
        }
    }

    #[test]
    fn the_tables_fill_the_file_without_gap() {
        let mut end = 0;
        for table in &TABLES {
            assert_eq!(table.offset, end, "{}", table.name);
            end += table.count * table.side.pow(2).div_ceil(8);
        }
        assert_eq!(end, CODES.len());
    }

    #[test]
    fn a_turned_and_damaged_pattern_is_still_the_same_tag() {
        let dictionary = TagDictionary::named("36h11").unwrap();
        let seen = turned_back(turned_back(turned_back(dictionary.code(400), 6), 6), 6) ^ 0b1010;
        assert_eq!(dictionary.nearest(seen), Some((2, 400, 1)));
        assert_eq!(dictionary.nearest(seen ^ 0xf00), None);
    }
}
