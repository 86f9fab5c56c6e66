'use strict';
// The classes of several materials, and what can be done about each.

/** Fill the panel of features: the classes of each material with a button for each offer. */
function fillFeatures(panel, facts, wishes, act) {
  if (!facts.classes.length) {
    panel.replaceChildren(element('p', 'quiet', facts.classes_note));
    return;
  }
  const parts = [element('p', 'quiet', `${facts.classes_note} A click shows the cells.`)];
  let last = null;
  facts.classes.forEach((about, pair) => {
    if (about.material !== last) parts.push(element('h2', '', about.material));
    last = about.material;
    const card = element('div', 'pair');
    card.append(element('strong', '', `row ${about.row}: ${about.class} at (${about.point.map((x) => show(x, 4)).join(', ')})`));
    card.append(element('p', 'quiet', `${about.is_there ? 'there' : 'not there'}; share of the score from ${show(about.birth, 4)} to ${show(about.death, 4)}`));
    const buttons = element('div', 'buttons');
    for (const k of wishes.of(pair)) {
      const { why, do: what } = wishes.offers[k];
      if (why) card.append(element('p', 'quiet', `${what}: ${why}`));
      else buttons.append(offerButton(wishes, k, facts, act));
    }
    card.append(buttons);
    parts.push(card);
  });
  panel.replaceChildren(...parts);
}

/** Return in words what an offer changes beside its cells. */
function describeOffer(wishes, { classes }) {
  const { offer } = wishes;
  const { material } = classes[offer.pair];
  const others = offer.others ? `; also ${offer.others}` : '';
  return `With ${wishes.describe(wishes.shown)}: ${material} has Betti numbers ${offer.betti.join(', ')}; volume ${offer.volumes}${others}`;
}
