// Light or dark: as the system says, or as was chosen here.

import { button } from '../dom';

type Theme = 'auto' | 'light' | 'dark';
const NEXT: Record<Theme, Theme> = { auto: 'light', light: 'dark', dark: 'auto' };
const SIGNS: Record<Theme, string> = { auto: '◐', light: '☀', dark: '☾' };
const PLACE = 'cohelm.desk.theme';

/** A button that goes through the themes. */
export function themeSwitch(): HTMLButtonElement {
  let theme = kept();
  const made = button('', { class: 'quiet-button' }, () => {
    theme = NEXT[theme];
    keep(theme);
    show();
  });
  const show = () => {
    if (theme === 'auto') delete document.documentElement.dataset['theme'];
    else document.documentElement.dataset['theme'] = theme;
    made.textContent = SIGNS[theme];
    made.title = theme === 'auto' ? 'Light or dark as the system says' : `Always ${theme}`;
    made.setAttribute('aria-label', `Theme: ${made.title}`);
  };
  show();
  return made;
}

function kept(): Theme {
  try {
    const theme = localStorage.getItem(PLACE);
    return theme === 'light' || theme === 'dark' ? theme : 'auto';
  } catch {
    return 'auto';
  }
}

function keep(theme: Theme): void {
  try {
    localStorage.setItem(PLACE, theme);
  } catch {
    // A browser that keeps nothing shows what the system says the next time.
  }
}
