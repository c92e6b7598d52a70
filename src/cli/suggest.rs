//! The known name that was probably meant.

/// Similarity (Jaro–Winkler, 0 to 1) below which a name is not worth suggesting.
const SIMILAR: f64 = 0.8;

/// `; did you mean "…"?` with the nearest of `known`, or nothing if none is near.
pub fn did_you_mean<'a>(word: &str, known: impl IntoIterator<Item = &'a str>) -> String {
    nearest(word, known).map_or_else(String::new, |name| format!("; did you mean \"{name}\"?"))
}

fn nearest<'a>(word: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let word = word.to_lowercase();
    known
        .into_iter()
        .map(|name| (strsim::jaro_winkler(&word, &name.to_lowercase()), name))
        .filter(|(similarity, _)| *similarity >= SIMILAR)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, name)| name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_name_is_suggested_and_nonsense_gets_none() {
        let known = ["jensen-box", "caustic-ring", "furnace"];
        assert_eq!(nearest("jensenbox", known), Some("jensen-box"));
        assert_eq!(nearest("Furnance", known), Some("furnace"));
        assert_eq!(nearest("qqqq", known), None);
        assert_eq!(did_you_mean("x", []), "");
    }
}
