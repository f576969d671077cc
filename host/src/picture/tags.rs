//! A sheet of tags to print: true to scale in millimetres, with a ruler to check the printer by.

use super::svg::Svg;
use crate::vision::TagDictionary;
use std::fmt::Write;

/// An A4 sheet and its margin, mm.
const SHEET: [f64; 2] = [210.0, 297.0];
const MARGIN: f64 = 12.0;
/// Room for a tag's number below it, and for the ruler at the foot of the sheet, mm.
const CAPTION: f64 = 7.0;
const FOOT: f64 = 18.0;
/// The height of letters, mm.
const LETTERS: f64 = 3.5;
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
    let mut svg = Svg::sheet(SHEET[0], SHEET[1]);
    for (place, &id) in ids.iter().enumerate() {
        let (x, y) = (
            MARGIN + card * (place % columns) as f64,
            MARGIN + (card + CAPTION) * (place / columns) as f64,
        );
        card_of(&mut svg, dictionary, id, [x, y, cell])?;
    }
    ruler(&mut svg);
    Some(svg.finish(&[]))
}

/// One tag with its rim, cutting line and number.
fn card_of(
    svg: &mut Svg,
    dictionary: TagDictionary,
    id: usize,
    [x, y, cell]: [f64; 3],
) -> Option<()> {
    let ring = dictionary.side() + 2;
    let cells = dictionary.cells(id)?;
    let card = cell * (ring + 2) as f64;
    svg.rect((x, y), (card, card), "cut-line");
    let mut black = String::new();
    for place in (0..ring * ring).filter(|&place| !cells[place]) {
        let (column, row) = ((place % ring + 1) as f64, (place / ring + 1) as f64);
        // Writing into a string cannot fail.
        let _ = write!(
            black,
            "M{:.3} {:.3}h{cell:.3}v{cell:.3}h-{cell:.3}z",
            x + column * cell,
            y + row * cell
        );
    }
    svg.path(&black, "ink");
    let name = format!("{} {id}, {:.1} mm", dictionary.name(), cell * ring as f64);
    svg.text((x + cell, y + card + 4.5), "caption", "start", LETTERS, &name);
    Some(())
}

fn ruler(svg: &mut Svg) {
    let foot = SHEET[1] - MARGIN;
    let mut line = format!("M{MARGIN} {foot}h{RULER}");
    for mark in (0..=RULER).step_by(10) {
        // Writing into a string cannot fail.
        let _ = write!(line, "M{} {foot}v-3", MARGIN + mark as f64);
    }
    svg.path(&line, "ink-line");
    let advice = format!(
        "This line is {RULER} mm long: print at 100 %, and give the measured size of the black squares where it is not."
    );
    svg.text((MARGIN, foot - 5.0), "caption", "start", LETTERS, &advice);
}
