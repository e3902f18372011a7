//! Colours on light and dark pages, and the beginning of a picture.

use std::fmt::Write;

use super::marks::escaped;
use super::{AVOIDED, COLOURS, SOLID};

/// Axes, and what is said about the picture.
pub(super) const MUTED: &str = "muted";

/// Names of colours, their classes, and how they are on light and on dark pages.
const NAMED: [(&str, &str, &str, &str); 5] = [
    ("black", "k", "#1f2328", "#e6edf3"),
    ("white", "w", "#ffffff", "#0d1117"),
    (MUTED, "m", "#6e7781", "#9198a1"),
    (SOLID, "s", "#b8bcc2", "#59616b"),
    (AVOIDED, "a", "#e3e6ea", "#2d343c"),
];

/// `COLOURS` on dark pages.
const DARK: [&str; COLOURS.len()] =
    ["#58a6ff", "#ff9248", "#2fc796", "#e8a2cb", "#f2c14e", "#9ad4fa", "#a5adb6"];

/// The attribute that sets the current colour: that of the theme, or any of SVG.
pub(super) fn paint(colour: &str) -> String {
    let number = COLOURS.iter().position(|own| *own == colour);
    let named = NAMED.iter().find(|own| own.0 == colour);
    match (number, named) {
        (Some(number), _) => format!("class=\"c{number}\""),
        (_, Some((_, class, ..))) => format!("class=\"{class}\""),
        _ => format!("color=\"{}\"", escaped(colour)),
    }
}

/// The rules of the colours, without those that a picture has no use for.
fn rules(body: &str, is_dark: bool) -> String {
    let pick = |light, dark| if is_dark { dark } else { light };
    let mut text = String::new();
    let mut add = |class: String, colour: &str| {
        if body.contains(&format!("class=\"{class}\"")) {
            let _ = write!(text, ".carom .{class}{{color:{colour}}}");
        }
    };
    for (_, class, light, dark) in NAMED {
        add(class.to_owned(), pick(light, dark));
    }
    for (k, (light, dark)) in COLOURS.into_iter().zip(DARK).enumerate() {
        add(format!("c{k}"), pick(light, dark));
    }
    let [ink, paper] = [0, 1].map(|k: usize| pick(NAMED[k].2, NAMED[k].3));
    let _ = write!(text, ".carom{{color:{ink}}}.carom .paper{{fill:{paper}}}");
    let _ = write!(text, ".carom .h{{stroke:{paper}}}");
    text
}

/// The whole picture around what is drawn. It says what it is to those who do not see it, follows
/// the page from light to dark, and shows nothing that moves to those who ask for that.
pub(super) fn finish([width, height]: [f64; 2], title: &str, about: &str, body: &str) -> String {
    let mut style = String::from(
        ".carom text{fill:currentColor}.carom .h{stroke-width:3px;stroke-linejoin:round;\
         stroke-opacity:.8;paint-order:stroke}",
    );
    style += &rules(body, false);
    let _ = write!(style, "\n@media (prefers-color-scheme:dark){{{}}}", rules(body, true));
    if body.contains("class=\"live\"") {
        style += "\n@media (prefers-reduced-motion:reduce){.carom .live{display:none}}";
    }
    let (title, about) = (escaped(&title.replace('\n', ". ")), escaped(about));
    let about = if about.is_empty() { about } else { format!("<desc>{about}</desc>\n") };
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"carom\" role=\"img\" \
         width=\"{width:.0}\" height=\"{height:.0}\" viewBox=\"0 0 {width:.2} {height:.2}\">\n\
         <title>{title}</title>\n{about}<style>{style}</style>\n\
         <rect class=\"paper\" width=\"100%\" height=\"100%\" rx=\"6\" fill=\"#fff\"/>\n\
         <g font-family=\"system-ui,sans-serif\" font-size=\"13\">\n{body}</g>\n</svg>\n"
    )
}
