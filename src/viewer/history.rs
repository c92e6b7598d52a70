//! Undo and redo of view, settings and display.

use super::display::Display;
use super::model::{Model, PictureSize};
use crate::engine::scene::desc::CameraDesc;
use crate::engine::session::Settings;

/// Steps that are remembered.
const STEPS: usize = 200;

/// What undo brings back.
#[derive(Clone, PartialEq)]
struct Snapshot {
    view: CameraDesc,
    size: PictureSize,
    settings: Settings,
    display: Display,
}

impl Snapshot {
    fn of(model: &Model) -> Self {
        Self {
            view: model.view,
            size: model.size,
            settings: model.settings.clone(),
            display: model.display,
        }
    }

    fn restore(&self, model: &mut Model) {
        model.view = self.view;
        model.size = self.size;
        model.settings = self.settings.clone();
        model.display = self.display;
    }
}

/// The past and the undone future of a model.
pub struct History {
    current: Snapshot,
    past: Vec<Snapshot>,
    future: Vec<Snapshot>,
}

impl History {
    /// Starts at `model`.
    pub fn new(model: &Model) -> Self {
        Self {
            current: Snapshot::of(model),
            past: Vec::new(),
            future: Vec::new(),
        }
    }

    /// Takes note of a change once the hand is off it: a whole drag is one step.
    pub fn observe(&mut self, model: &Model, busy: bool) {
        if busy {
            return;
        }
        let now = Snapshot::of(model);
        if now == self.current {
            return;
        }
        self.past.push(std::mem::replace(&mut self.current, now));
        if self.past.len() > STEPS {
            self.past.remove(0);
        }
        self.future.clear();
    }

    /// Goes one step back.
    pub fn undo(&mut self, model: &mut Model) {
        self.observe(model, false);
        if let Some(previous) = self.past.pop() {
            self.future
                .push(std::mem::replace(&mut self.current, previous));
            self.current.restore(model);
        }
    }

    /// Goes one undone step forward.
    pub fn redo(&mut self, model: &mut Model) {
        self.observe(model, false);
        if let Some(next) = self.future.pop() {
            self.past.push(std::mem::replace(&mut self.current, next));
            self.current.restore(model);
        }
    }

    /// Whether there is a step back.
    pub fn can_undo(&self) -> bool {
        !self.past.is_empty()
    }

    /// Whether there is an undone step.
    pub fn can_redo(&self) -> bool {
        !self.future.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::viewer::source::SceneSource;

    fn model() -> Model {
        Model::new(SceneSource::Embedded("x".to_owned()))
    }

    #[test]
    fn a_drag_is_one_step() {
        let mut model = model();
        let mut history = History::new(&model);
        for i in 1..=10 {
            model.view.position.x = i as f32;
            history.observe(&model, true);
        }
        history.observe(&model, false);
        history.undo(&mut model);
        assert_eq!(model.view, CameraDesc::default());
        assert!(!history.can_undo());
        history.redo(&mut model);
        assert_eq!(model.view.position.x, 10.0);
        assert!(!history.can_redo());
    }

    #[test]
    fn a_new_change_forgets_what_was_undone() {
        let mut model = model();
        let mut history = History::new(&model);
        model.settings.seed = 7;
        history.observe(&model, false);
        history.undo(&mut model);
        assert_eq!(model.settings.seed, 0);
        model.display.exposure = 2.0;
        history.observe(&model, false);
        assert!(history.can_undo() && !history.can_redo());
    }

    #[test]
    fn the_oldest_steps_are_forgotten() {
        let mut model = model();
        let mut history = History::new(&model);
        for i in 0..2 * STEPS {
            model.settings.seed = i as u64 + 1;
            history.observe(&model, false);
        }
        while history.can_undo() {
            history.undo(&mut model);
        }
        assert_eq!(model.settings.seed, STEPS as u64);
    }
}
