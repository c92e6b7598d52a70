//! Sentences for the user: errors stay until they are mended, messages go by themselves.

/// How long a message stays, in seconds.
const SECONDS: f64 = 8.0;

/// What there is to say.
#[derive(Default)]
pub struct Notices {
    errors: Vec<(&'static str, String)>,
    messages: Vec<(f64, String)>,
    fresh: Vec<String>,
}

impl Notices {
    /// Shows an error about `subject` in place of the last one about it.
    pub fn set_error(&mut self, subject: &'static str, sentence: String) {
        self.clear_error(subject);
        self.errors.push((subject, sentence));
    }

    /// The error about `subject` is mended, or the user has read it.
    pub fn clear_error(&mut self, subject: &str) {
        self.errors.retain(|(s, _)| *s != subject);
    }

    /// Says something that needs no answer.
    pub fn say(&mut self, sentence: impl Into<String>) {
        self.fresh.push(sentence.into());
    }

    /// Lets old messages go at `now` (seconds of the window's clock).
    pub fn tick(&mut self, now: f64) {
        let fresh = self.fresh.drain(..).map(|text| (now + SECONDS, text));
        self.messages.extend(fresh);
        self.messages.retain(|(until, _)| *until > now);
    }

    /// Seconds until the next message goes.
    pub fn next_change(&self, now: f64) -> Option<f64> {
        let ends = self.messages.iter().map(|(until, _)| until - now);
        ends.min_by(f64::total_cmp)
    }

    /// Errors with their subjects.
    pub fn errors(&self) -> &[(&'static str, String)] {
        &self.errors
    }

    /// Messages.
    pub fn messages(&self) -> impl Iterator<Item = &str> {
        self.messages.iter().map(|(_, text)| text.as_str())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_stay_until_they_are_mended() {
        let mut notices = Notices::default();
        notices.set_error("scene", "line 3".to_owned());
        notices.set_error("scene", "line 4".to_owned());
        notices.tick(1e6);
        assert_eq!(notices.errors(), [("scene", "line 4".to_owned())]);
        notices.clear_error("scene");
        assert!(notices.errors().is_empty());
    }

    #[test]
    fn messages_go_by_themselves() {
        let mut notices = Notices::default();
        notices.say("saved");
        notices.tick(100.0);
        assert_eq!(notices.messages().collect::<Vec<_>>(), ["saved"]);
        assert_eq!(notices.next_change(100.0), Some(SECONDS));
        notices.tick(100.0 + SECONDS);
        assert_eq!(notices.messages().count(), 0);
        assert_eq!(notices.next_change(200.0), None);
    }
}
