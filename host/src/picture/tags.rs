//! A sheet of tags to print: true to scale in millimetres, with a ruler to check the printer by.

use crate::vision::TagDictionary;
use std::fmt::Write;

/// An A4 sheet and its margin, mm.
const SHEET: [f64; 2] = [210.0, 297.0];
const MARGIN: f64 = 12.0;
/// Room for a tag's number below it, and for the ruler at the foot of the sheet, mm.
const CAPTION: f64 = 7.0;
const FOOT: f64 = 18.0;
/// The ruler's length, mm.
const RULER: usize = 100;

/// The sheet with these tags as SVG, each `size` metres wide across its black ring, with a white rim of one
/// cell and a thin line to cut along; `None` if the dictionary has no such tag, or they do not fit on one
/// sheet.
///
/// ```
/// use wmr::{picture::tags::tag_sheet, vision::TagDictionary};
/// let dictionary = TagDictionary::named("4X4_50").ok_or("no such dictionary")?;
/// let svg = tag_sheet(dictionary, &[0, 1, 2, 3, 7], 0.05).ok_or("they do not fit")?;
/// assert!(svg.contains("width=\"210mm\"") && svg.contains("DICT_4X4_50 7"));
/// assert_eq!(tag_sheet(dictionary, &[50], 0.05), None);
/// # Ok::<(), &str>(())
/// ```
pub fn tag_sheet(dictionary: TagDictionary, ids: &[usize], size: f64) -> Option<String> {
    let ring = dictionary.side() + 2;
    let cell = size * 1000.0 / ring as f64;
    let card = cell * (ring + 2) as f64;
    let columns = ((SHEET[0] - 2.0 * MARGIN) / card).floor() as usize;
    let rows = ((SHEET[1] - 2.0 * MARGIN - FOOT) / (card + CAPTION)).floor() as usize;
    if !(card > 0.0 && columns * rows >= ids.len()) {
        return None;
    }
    let [width, height] = SHEET;
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}mm\" height=\"{height}mm\" \
         viewBox=\"0 0 {width} {height}\" font-family=\"sans-serif\" font-size=\"3.5\">\n\
         <rect width=\"{width}\" height=\"{height}\" fill=\"#ffffff\"/>\n"
    );
    for (place, &id) in ids.iter().enumerate() {
        let (x, y) = (
            MARGIN + card * (place % columns) as f64,
            MARGIN + (card + CAPTION) * (place / columns) as f64,
        );
        card_of(&mut svg, dictionary, id, [x, y, cell])?;
    }
    ruler(&mut svg);
    Some(svg + "</svg>\n")
}

/// One tag with its rim, cutting line and number.
fn card_of(
    svg: &mut String,
    dictionary: TagDictionary,
    id: usize,
    [x, y, cell]: [f64; 3],
) -> Option<()> {
    let ring = dictionary.side() + 2;
    let cells = dictionary.cells(id)?;
    let card = cell * (ring + 2) as f64;
    // Writing into a string cannot fail.
    let _ = writeln!(
        svg,
        "<rect x=\"{x:.3}\" y=\"{y:.3}\" width=\"{card:.3}\" height=\"{card:.3}\" fill=\"none\" stroke=\"#b0b0b0\" stroke-width=\"0.1\"/>"
    );
    let _ = write!(svg, "<path fill=\"#000000\" d=\"");
    for place in (0..ring * ring).filter(|&place| !cells[place]) {
        let (column, row) = ((place % ring + 1) as f64, (place / ring + 1) as f64);
        let _ = write!(
            svg,
            "M{:.3} {:.3}h{cell:.3}v{cell:.3}h-{cell:.3}z",
            x + column * cell,
            y + row * cell
        );
    }
    let _ = writeln!(svg, "\"/>");
    let _ = writeln!(
        svg,
        "<text x=\"{:.2}\" y=\"{:.2}\">{} {id}, {:.1} mm</text>",
        x + cell,
        y + card + 4.5,
        dictionary.name(),
        cell * ring as f64
    );
    Some(())
}

fn ruler(svg: &mut String) {
    let foot = SHEET[1] - MARGIN;
    let _ =
        write!(svg, "<path stroke=\"#000000\" stroke-width=\"0.2\" d=\"M{MARGIN} {foot}h{RULER}");
    for mark in (0..=RULER).step_by(10) {
        let _ = write!(svg, "M{} {foot}v-3", MARGIN + mark as f64);
    }
    let _ = writeln!(
        svg,
        "\"/>\n<text x=\"{MARGIN}\" y=\"{:.1}\">This line is {RULER} mm long: print at 100 %, and give the \
         measured size of the black squares where it is not.</text>",
        foot - 5.0
    );
}
