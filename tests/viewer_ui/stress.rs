//! Scenes with a closed form, their sliders, and the verdict.

use egui_kittest::kittest::Queryable;
use lightscope::engine::math::Rgb;
use lightscope::viewer::source::SceneSource;
use lightscope::viewer::workspace::{Request, Workspace};

use crate::desk::{Desk, desk_of_section, desk_with_section, workspace_of};

fn experiment(id: &str, passes: u64) -> Workspace {
    workspace_of(SceneSource::named(id), passes)
}

fn stressed(workspace: Workspace) -> Desk {
    let mut desk = desk_of_section(workspace, "Stress");
    desk.run_steps(3);
    desk
}

fn asked_for(desk: &Desk) -> Option<String> {
    let mut asked = desk.state().requests.iter().rev();
    asked.find_map(|request| match request {
        Request::Load(source) => Some(source.short_name()),
        _ => None,
    })
}

#[test]
fn an_experiment_is_chosen_and_driven() {
    let mut desk = desk_with_section("Stress");
    desk.run_steps(3);
    desk.get_by_label("Experiment").click();
    desk.run_steps(3);
    desk.get_by_label("room").click();
    desk.run_steps(3);
    assert_eq!(asked_for(&desk).as_deref(), Some("stress:room"));

    let mut desk = stressed(experiment("stress:room,scale=10", 2));
    desk.get_by_role_and_label(egui::Role::Slider, "Albedo")
        .set_value_accesskit(0.9);
    desk.run_steps(3);
    let id = asked_for(&desk).expect("another scene");
    assert_eq!(id, "stress:room,scale=10,albedo=0.9");
}

#[test]
fn the_verdict_is_that_of_the_picture() {
    let desk = stressed(experiment("stress:ball,albedo=0.8", 64));
    assert!(desk.query_by_label("holds").is_some());
    assert!(desk.query_by_label("0.800000").is_some());

    // The same picture, three percent too bright.
    let mut wrong = experiment("stress:ball,albedo=0.8", 64);
    let frame = wrong.frame.clone().expect("a picture");
    let mut frame = (*frame).clone();
    for pixel in &mut frame.layers[0].pixels {
        *pixel = (Rgb::from(*pixel) * 1.03).into();
    }
    wrong.show_frame(frame.into());
    assert!(stressed(wrong).query_by_label("WRONG").is_some());

    // A counted error is one, however right the mean.
    let mut leaking = experiment("stress:ball,albedo=0.8", 64);
    let frame = leaking.frame.clone().expect("a picture");
    let mut frame = (*frame).clone();
    frame.stats.missed_edges = 1;
    leaking.show_frame(frame.into());
    assert!(stressed(leaking).query_by_label("WRONG").is_some());
}

#[test]
fn no_verdict_where_the_closed_form_is_another() {
    let mut short = experiment("stress:room", 64);
    short.model.settings.layers.max_depth = Some(2);
    let desk = stressed(short);
    assert!(desk.query_by_label("holds").is_none());
    assert!(desk.query_by_label("WRONG").is_none());
    assert!(desk.query_by_label_contains("of all light").is_some());

    let mut moved = experiment("stress:room", 64);
    moved.model.view.vfov_deg += 5.0;
    let desk = stressed(moved);
    assert!(desk.query_by_label_contains("own view").is_some());
}
