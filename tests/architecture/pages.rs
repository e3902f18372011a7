//! A page of the guide is read in its folder and as a module. In both, its links lead somewhere if it
//! names pages by references, which `src/guide.rs` defines anew for the module.

use std::fs;
use std::path::Path;

fn text(file: &str) -> String {
    fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(file)).expect(file)
}

/// The pages that are modules, each with the lines before it that define references.
fn pages(guide: &str) -> Vec<(String, String)> {
    let items = guide.split("\n\n").flat_map(|paragraph| paragraph.split(" {}"));
    let documented =
        items.filter(|item| item.contains("include_str!") && !item.contains("doctest"));
    let page = |item: &str| {
        let file = item.split("include_str!(\"../").nth(1)?.split('"').next()?;
        Some((file.to_owned(), item.to_owned()))
    };
    documented.filter_map(page).collect()
}

/// What a line defines, if it defines a link to another page.
fn reference(line: &str) -> Option<&str> {
    let (name, target) = line.strip_prefix('[')?.split_once("]: ")?;
    target.split('#').next()?.ends_with(".md").then_some(name)
}

#[test]
fn links_between_pages_lead_somewhere_in_the_guide() {
    let pages = pages(&text("src/guide.rs"));
    assert!(pages.len() > 15, "{} pages", pages.len());
    for (file, item) in pages {
        for (number, line) in text(&file).lines().enumerate() {
            let place = format!("{file}:{}", number + 1);
            let inline = line.split("](").skip(1).filter_map(|rest| rest.split(')').next());
            for target in inline.filter(|target| !target.contains("://")) {
                assert!(!target.contains(".md"), "{place} names {target} in the text");
            }
            if let Some(name) = reference(line) {
                let defined = format!("#[doc = \"[{name}]: ");
                assert!(item.contains(&defined), "{place}: {name} is not defined in src/guide.rs");
            }
        }
    }
}
