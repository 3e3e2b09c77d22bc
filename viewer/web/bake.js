// Clicks on the image. While a bake is watched, a click reports the cell.
'use strict';

const CLICK_PIXELS = 4;  // a longer movement with the button pressed is a drag

const onClick = [reportCell];  // functions that get the event of a click
let pressed = null;            // position at which the button was pressed

picture.addEventListener('pointerdown', (event) => { pressed = [event.clientX, event.clientY]; });
picture.addEventListener('pointerup', (event) => {
  const isClick = pressed && Math.hypot(event.clientX - pressed[0], event.clientY - pressed[1]) < CLICK_PIXELS;
  if (isClick) for (const listen of onClick) listen(event);
  pressed = null;
});

async function reportCell(event) {
  if (!viewer || !shownState || !shownState.watching) return;
  const box = picture.getBoundingClientRect();
  const [x, y] = [(event.clientX - box.left) / box.width, (event.clientY - box.top) / box.height].map(inPicture);
  try {
    const {cell} = await ask(`${forViewer('cell')}&x=${x}&y=${y}`);
    note(cell ? cellText(cell) : '', 20000);
  } catch (failure) {
    note(failure.message, 10000);
  }
}

function cellText(cell) {
  const some = cell.tiles.slice(0, 8).join(', ') + (cell.tiles.length > 8 ? ', …' : '');
  const parts = [`${cell.name}: ${cell.state}`, `${cell.triangles} triangles, ${(100 * cell.cost).toFixed(1)} % of the cost`];
  if (cell.seconds > 0) parts.push(`${cell.seconds.toFixed(1)} s, ${cell.voxels} voxels`);
  parts.push(`${cell.tiles.length} tiles: ${some}`);
  if (cell.error) parts.push(cell.error);
  return parts.join(' · ');
}
