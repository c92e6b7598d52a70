//! A walk through what a newcomer does.

use crate::screen::{HEIGHT, Program, Screen, WIDTH, difference, mean, reference, saved};

#[test]
fn drag_resize_solo_screenshot_quit() {
    let Some(screen) = Screen::start() else {
        return;
    };
    let folder = tempfile::tempdir().expect("a folder");
    let mut program = Program::start(&screen, folder.path(), &reference("cornell-diffuse"));
    program.wait_for_picture();
    let still = program.settle();

    program.drag("1", [250, 250], [120, 40]);
    program.wait_for("a drag turns the view", |p| difference(p, &still) > 8.0);
    program.key("Home");
    program.wait_for("Home leads back", |p| difference(p, &still) < 3.0);

    type Move<'a> = (&'a str, &'a dyn Fn());
    let moves: [Move; 4] = [
        ("a right drag pans", &|| {
            program.drag("3", [250, 250], [90, 60])
        }),
        ("the wheel comes closer", &|| program.wheel([250, 250], 3)),
        ("the wheel goes away", &|| program.wheel([250, 250], -3)),
        ("W flies", &|| program.hold("w", 0.6)),
    ];
    for (what, act) in moves {
        act();
        program.wait_for(what, |p| difference(p, &still) > 3.0);
        program.key("Home");
        program.wait_for("Home leads back", |p| difference(p, &still) < 3.0);
    }
    program.drag("1", [250, 250], [120, 40]);
    program.wait_for("a drag turns the view", |p| difference(p, &still) > 8.0);
    program.key("ctrl+z");
    program.wait_for("undo turns it back", |p| difference(p, &still) < 3.0);

    program.key("5");
    program.wait_for("four pictures, two of them dark in this scene", |p| {
        let tile = |x, y| mean(&image::imageops::crop_imm(p, x, y, 150, 150).to_image());
        let [direct, specular] = [tile(60, 80), tile(340, 80)];
        let [caustic, indirect] = [tile(60, 380), tile(340, 380)];
        direct > 15.0 && indirect > 15.0 && specular < 2.0 && caustic < 2.0
    });
    program.key("3");
    program.wait_for("there are no caustics here", |p| mean(p) < 2.0);
    program.key("0");
    program.wait_for("0 shows the whole again", |p| difference(p, &still) < 3.0);

    program.resize(700, 500);
    program.wait_for("another size is another picture", |p| {
        difference(p, &still) > 3.0
    });
    program.resize(900, 640);
    program.wait_for("the old size shows the old picture", |p| {
        difference(p, &still) < 3.0
    });

    program.key("ctrl+s");
    let png = image::open(saved(folder.path(), "spp.png"))
        .expect("a PNG")
        .to_rgb8();
    program.key("ctrl+e");
    let exr = saved(folder.path(), "spp.exr");
    let size = exr::meta::MetaData::read_from_file(&exr, false).expect("an EXR");
    let data = size.headers[0].shared_attributes.display_window.size;
    assert_eq!(
        (data.0, data.1),
        (png.width() as usize, png.height() as usize)
    );
    // The file holds what the window shows: the left top of it, pixel by pixel.
    let corner = image::imageops::crop_imm(&png, 0, 0, WIDTH, HEIGHT).to_image();
    let off = difference(&corner, &program.picture());
    assert!(off < 2.0, "the screenshot differs from the window by {off}");

    program.quit();
}
