//! The SVG writer of all pictures: shapes, text, a title and a legend, with y down.
//!
//! Shapes name classes of [`STYLE`], which alone holds colours, so that one colour means one thing throughout:
//! grey what is there, pink what the grid method draws, red what is closed, blue the way; over a photo red
//! what is seen, yellow how far it may reach, and blue-green the robot.

use std::fmt::Write;

/// Height of the strip that holds the title, pixels.
pub const TITLE_HEIGHT: f64 = 62.0;

const LEGEND_HEIGHT: f64 = 26.0;
const PAD: f64 = 18.0;

/// The classes that shapes may name.
pub const STYLE: &str = "\
text{font-family:'DejaVu Sans','Segoe UI',Helvetica,Arial,sans-serif;fill:#2b2f36}\
.title{font-size:19px;font-weight:bold}.subtitle{font-size:13px;fill:#5d6470}\
.legend{font-size:13px}.number{fill:#7c8491}.element{font-weight:bold}\
.page{fill:#faf9f6}.floor{fill:#ffffff;stroke:#2b2f36;stroke-width:2}\
.obstacle{fill:#5d6470}.grown{fill:#e3e0d8;stroke:#a9a496;stroke-width:1}.inflated{fill:#e3e0d8}\
.inside{fill:none;stroke:#a9a496;stroke-width:1.2;stroke-dasharray:6 4}\
.border-line{stroke:#e0559a;stroke-width:1.4}.area{stroke:#e0559a;stroke-width:.6;fill:#ffffff}\
.dead{fill:#dedbd3}.live{fill:#eef6ee}.terminal{fill:#ffe9a8}.trap{fill:#f3b3ad}.chosen{fill:#dbe8fb}\
.edge{stroke:#b5bac3;stroke-width:1.3;fill:none}.best-edge{stroke:#1f6fd6;stroke-width:3;fill:none}\
.node{fill:#ffffff;stroke:#8a919d;stroke-width:1.2}.best-node{fill:#1f6fd6;stroke:#1f6fd6}\
.free0{fill:#8e5a63}.free1{fill:#c0717a}.free2{fill:#dd9590}.free3{fill:#edb9aa}.free4{fill:#f6d8c9}.free5{fill:#fcefe6}\
.on-dark{fill:#ffffff}.path{fill:none;stroke:#1f6fd6;stroke-width:3.5;stroke-linejoin:round}\
.local{fill:none;stroke:#1f6fd6;stroke-width:1.4;stroke-dasharray:3 4}\
.planned{fill:none;stroke:#8a919d;stroke-width:2;stroke-dasharray:6 4}\
.measured{fill:none;stroke:#1f6fd6;stroke-width:2}.scale{stroke:#dedbd3;stroke-width:1;fill:none}\
.ruler{stroke:#7c8491;stroke-width:1.5;fill:none}.robot{fill:#00798c;fill-opacity:.3;stroke:#00798c;stroke-width:2}\
.heading{stroke:#00798c;stroke-width:3;fill:none}\
.kept{fill:#1f6fd6}.dropped{fill:#ffffff;stroke:#1f6fd6;stroke-width:1.4}\
.start{fill:#2e9e5b;stroke:#ffffff;stroke-width:1.5}.goal{fill:#d64533;stroke:#ffffff;stroke-width:1.5}\
.seen{fill:#d1495b;fill-opacity:.2;stroke:#d1495b;stroke-width:2.5}\
.seen-number{font-weight:bold;fill:#ffffff;stroke:#d1495b;stroke-width:5;paint-order:stroke}\
.seen-height{fill:#8c1c2e}.seen-borders{fill:#ff69b4}\
.candidate{fill:none;stroke:#d1495b;stroke-width:2}.candidate-name{fill:#d1495b}\
.footprint{fill:none;stroke:#d1495b;stroke-width:3}.top{fill:none;stroke:#edae49;stroke-width:3}\
.upright{fill:none;stroke:#edae49;stroke-width:2}\
.margin{fill:none;stroke:#edae49;stroke-width:2;stroke-dasharray:6 4}\
.margin-band{fill:none;stroke:#edae49;stroke-opacity:.5;stroke-linejoin:round}\
.seen-robot{fill:#00798c;fill-opacity:.45;stroke:#00798c;stroke-width:3}\
.seen-heading{fill:none;stroke:#00798c;stroke-width:5;stroke-linecap:round}\
.photo-planned{fill:none;stroke:#ffffff;stroke-width:9;stroke-linejoin:round;stroke-linecap:round}\
.photo-driven{fill:none;stroke:#1f6fd6;stroke-width:4;stroke-linejoin:round;stroke-linecap:round}\
.ground{fill:#ffffff;stroke:#2b2f36;stroke-width:3}\
.film-planned{fill:none;stroke:#999999;stroke-width:3;stroke-dasharray:8 6}\
.film-robot{fill:#1f6fd6;fill-opacity:.35;stroke:#1f6fd6;stroke-width:2}.film-heading{stroke:#0b3a78;stroke-width:4}\
.paper{fill:#ffffff}.ink{fill:#000000}.ink-line{fill:none;stroke:#000000;stroke-width:.2}\
.cut-line{fill:none;stroke:#b0b0b0;stroke-width:.1}";

/// What a legend shows before its text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Swatch {
    /// A filled square of a class.
    Fill(&'static str),
    /// A line of a class.
    Line(&'static str),
    /// A dot of a class.
    Dot(&'static str),
}

/// How large a picture is shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Size {
    /// A unit of the drawing is a pixel.
    Pixels,
    /// A unit of the drawing is a millimetre, in print.
    Millimetres,
    /// As large as there is room.
    Any,
}

/// An SVG picture in the making.
#[derive(Clone, Debug)]
pub struct Svg {
    /// Left and upper edge, width and height of what is shown, units of the drawing.
    view: [f64; 4],
    size: Size,
    body: String,
}

impl Svg {
    /// An empty picture of `width` × `height` pixels below a strip with `title` and `subtitle`.
    ///
    /// ```
    /// let mut svg = wmr::picture::svg::Svg::new(200.0, 100.0, "Areas", "none < one");
    /// svg.circle((20.0, 80.0), 5.0, "start");
    /// assert!(svg.finish(&[]).contains("none &lt; one"));
    /// ```
    pub fn new(width: f64, height: f64, title: &str, subtitle: &str) -> Self {
        let mut svg = Self::empty([0.0, 0.0, width, height + TITLE_HEIGHT], Size::Pixels);
        svg.add(format_args!("<rect width=\"100%\" height=\"100%\" class=\"page\"/>"));
        svg.text((PAD, 27.0), "title", "start", 19.0, title);
        svg.text((PAD, 48.0), "subtitle", "start", 13.0, subtitle);
        svg
    }

    /// A picture of a size in pixels that a PNG fills.
    pub fn over((width, height): (f64, f64), png: &[u8]) -> Self {
        let mut svg = Self::empty([0.0, 0.0, width, height], Size::Pixels);
        svg.add(format_args!(
            "<image width=\"{width:.1}\" height=\"{height:.1}\" href=\"data:image/png;base64,{}\"/>",
            base64(png)
        ));
        svg
    }

    /// A white sheet to print, `width` × `height` millimetres.
    pub fn sheet(width: f64, height: f64) -> Self {
        let mut svg = Self::empty([0.0, 0.0, width, height], Size::Millimetres);
        svg.rect((0.0, 0.0), (width, height), "paper");
        svg
    }

    /// A picture of what lies within `view`, left and upper edge, width and height, that is shown as large as
    /// there is room; programs that read pictures aloud say its `title`.
    pub fn scalable(view: [f64; 4], title: &str) -> Self {
        let mut svg = Self::empty(view, Size::Any);
        svg.add(format_args!("<title>{}</title>", escaped(title)));
        svg
    }

    fn empty(view: [f64; 4], size: Size) -> Self {
        Self { view, size, body: String::new() }
    }

    /// A rectangle from its upper-left corner, size in pixels.
    pub fn rect(&mut self, (x, y): (f64, f64), (width, height): (f64, f64), class: &str) {
        self.add(format_args!(
            "<rect x=\"{x:.2}\" y=\"{y:.2}\" width=\"{width:.2}\" height=\"{height:.2}\" class=\"{class}\"/>"
        ));
    }

    /// A line through `points`.
    pub fn polyline(&mut self, points: &[(f64, f64)], class: &str) {
        self.add(format_args!("<polyline points=\"{}\" class=\"{class}\"/>", listed(points)));
    }

    /// A filled polygon with these corners.
    pub fn polygon(&mut self, corners: &[(f64, f64)], class: &str) {
        self.add(format_args!("<polygon points=\"{}\" class=\"{class}\"/>", listed(corners)));
    }

    /// The outline of a polygon with these corners, so wide.
    pub fn band(&mut self, corners: &[(f64, f64)], width: f64, class: &str) {
        self.add(format_args!(
            "<polygon points=\"{}\" class=\"{class}\" stroke-width=\"{width:.2}\"/>",
            listed(corners)
        ));
    }

    /// What the commands of an SVG path draw.
    pub fn path(&mut self, commands: &str, class: &str) {
        self.add(format_args!("<path d=\"{commands}\" class=\"{class}\"/>"));
    }

    /// A circle.
    pub fn circle(&mut self, (x, y): (f64, f64), radius: f64, class: &str) {
        self.add(format_args!(
            "<circle cx=\"{x:.2}\" cy=\"{y:.2}\" r=\"{radius:.2}\" class=\"{class}\"/>"
        ));
    }

    /// Text on its base line; `anchor` is `start`, `middle` or `end`, `size` in pixels.
    pub fn text(&mut self, (x, y): (f64, f64), class: &str, anchor: &str, size: f64, text: &str) {
        let text = escaped(text);
        self.add(format_args!(
            "<text x=\"{x:.2}\" y=\"{y:.2}\" class=\"{class}\" text-anchor=\"{anchor}\" font-size=\"{size:.1}\">{text}</text>"
        ));
    }

    /// The whole document, with a legend below the picture.
    pub fn finish(mut self, legend: &[(Swatch, &str)]) -> String {
        let [left, top, width, mut height] = self.view;
        let (mut x, mut y) = (PAD, height + 8.0);
        for (swatch, label) in legend {
            // About 7.6 pixels a letter; a new row where the next entry would not fit.
            let room = 44.0 + 7.6 * label.chars().count() as f64;
            if x > PAD && x + room > width {
                (x, y) = (PAD, y + LEGEND_HEIGHT);
            }
            self.swatch((x, y), *swatch);
            self.text((x + 26.0, y + 12.0), "legend", "start", 13.0, label);
            x += room;
            height = y + LEGEND_HEIGHT;
        }
        let size = match self.size {
            Size::Pixels => format!(" width=\"{width:.0}\" height=\"{height:.0}\""),
            Size::Millimetres => format!(" width=\"{width}mm\" height=\"{height}mm\""),
            Size::Any => String::new(),
        };
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\"{size} viewBox=\"{}\">\n\
             <style>{STYLE}</style>\n{}</svg>\n",
            [left, top, width, height]
                .map(|length| (10.0 * length).round() / 10.0)
                .map(|length| length.to_string())
                .join(" "),
            self.body
        )
    }

    fn swatch(&mut self, (x, y): (f64, f64), swatch: Swatch) {
        match swatch {
            Swatch::Fill(class) => self.rect((x, y), (18.0, 15.0), class),
            Swatch::Line(class) => self.polyline(&[(x, y + 7.5), (x + 20.0, y + 7.5)], class),
            Swatch::Dot(class) => self.circle((x + 9.0, y + 7.5), 6.0, class),
        }
    }

    /// An element as SVG has it.
    pub(super) fn add(&mut self, element: std::fmt::Arguments) {
        // Writing into a string cannot fail.
        let _ = writeln!(self.body, "{element}");
    }
}

/// Points as SVG lists them.
pub(super) fn listed(points: &[(f64, f64)]) -> String {
    let mut list = String::new();
    for (x, y) in points {
        // Writing into a string cannot fail.
        let _ = write!(list, "{x:.2},{y:.2} ");
    }
    list.truncate(list.trim_end().len());
    list
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

/// The bytes in base 64 (RFC 4648), as a data address wants them.
fn base64(bytes: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for group in bytes.chunks(3) {
        let bits =
            (0..3).fold(0u32, |bits, i| bits << 8 | u32::from(group.get(i).copied().unwrap_or(0)));
        for digit in 0..4 {
            let index = (bits >> (18 - 6 * digit) & 63) as usize;
            text.push(if digit <= group.len() { char::from(DIGITS[index]) } else { '=' });
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_legend_too_wide_for_one_row_takes_two() {
        let entries = [(Swatch::Dot("start"), "a rather long label"); 4];
        let height = |svg: &str| {
            svg.split("height=\"").nth(1).unwrap().split('"').next().unwrap().to_owned()
        };
        let narrow = Svg::new(300.0, 100.0, "", "").finish(&entries);
        let wide = Svg::new(1200.0, 100.0, "", "").finish(&entries);
        assert!(height(&narrow).parse::<u32>().unwrap() > height(&wide).parse::<u32>().unwrap());
    }

    #[test]
    fn base64_pads_as_the_standard_shows() {
        assert_eq!(
            ["", "f", "fo", "foo", "foobar"].map(|text| base64(text.as_bytes())),
            ["", "Zg==", "Zm8=", "Zm9v", "Zm9vYmFy"]
        );
    }
}
