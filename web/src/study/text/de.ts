// Everything that the participant's page itself says, in German.

import { directionOf } from '../../words';
import { clock, type Words } from './en';

const count = (many: number, one: string, more: string) => `${many} ${many === 1 ? one : more}`;

/** Directions alone: what moves there only the plant knows. Any other name is the plant's own. */
const DIRECTIONS: Record<string, string> = { left: 'links', right: 'rechts', up: 'hoch', down: 'runter' };
const control = (name: string) => DIRECTIONS[directionOf(name)] ?? name;

export const de: Words = {
  name: 'Deutsch',
  code: 'de',
  language: 'Sprache',
  test: 'Probelauf',
  simulated: 'Simulierte Person',
  progress: 'Fortschritt',
  stepOf: (step, of) => `Schritt ${step} von ${of}`,
  minutesLeft: (minutes) =>
    minutes < 1.5 ? 'noch etwa eine Minute' : `noch etwa ${count(Math.round(minutes), 'Minute', 'Minuten')}`,
  connected: 'Verbunden',
  offline: 'Keine Verbindung',
  offlineText: 'Nichts geht verloren: Es wird gesendet, sobald es wieder eine Verbindung gibt.',
  goOn: 'Weiter',
  back: 'Zurück',
  next: 'Weiter',
  askUs: (contact) => `Fragen? Kontakt: ${contact}`,

  withdraw: {
    open: 'Teilnahme beenden',
    title: 'Die Teilnahme zurückziehen?',
    text: 'Sie können jederzeit aufhören und müssen keinen Grund nennen. Wenn Sie sich zurückziehen, wird alles gelöscht, was in dieser Studie von Ihnen aufgezeichnet wurde. Das lässt sich nicht rückgängig machen.',
    pause:
      'Wenn Sie nur eine Pause brauchen, schließen Sie einfach die Seite: Mit Ihrem Link kommen Sie an diese Stelle zurück.',
    stay: 'In der Studie bleiben',
    confirm: 'Zurückziehen und meine Daten löschen',
    working: 'Wird gelöscht …',
  },

  consent: {
    title: 'Teilnahme an dieser Studie',
    minutes: (minutes) => `Sie dauert etwa ${count(Math.round(minutes), 'Minute', 'Minuten')}.`,
    version: (version) => `Fassung ${version} dieses Textes.`,
    leave: 'Mit „Teilnahme beenden“ oben auf der Seite können Sie jederzeit aufhören; Ihre Daten werden dann gelöscht.',
    agree: 'Ich habe dies gelesen und verstanden und nehme freiwillig teil.',
    start: 'Teilnehmen',
    decline: 'Ich nehme nicht teil',
  },

  device: {
    title: 'Ist dieses Gerät schnell genug?',
    text: 'Die Flüge brauchen einen gleichmäßigen Takt. Die Prüfung dauert fünf Sekunden; bitte tun Sie währenddessen nichts anderes an diesem Gerät.',
    start: 'Prüfung starten',
    running: 'Wird geprüft …',
    passed: 'Dieses Gerät ist schnell genug.',
    failed: 'Dieses Gerät hält den Takt nicht',
    failedText: (late) =>
      `${late} von 100 Schritten kamen zu spät. Schließen Sie andere Programme und Tabs, stecken Sie das Netzteil ein, schalten Sie den Energiesparmodus aus und versuchen Sie es noch einmal. Ein Rechner der letzten Jahre mit aktuellem Chrome, Edge, Firefox oder Safari ist schnell genug.`,
    refused: 'Mit diesem Gerät können Sie nicht teilnehmen; Ihr Link gilt auch auf einem anderen.',
    again: 'Noch einmal prüfen',
    anyway: 'Trotzdem weiter',
    small: 'Ihr Fenster ist recht klein. Bitte vergrößern Sie es, am besten auf den ganzen Bildschirm.',
    refresh: (hz) => `Anzeige: ${Math.round(hz)} Bilder in der Sekunde`,
    pace: (late, of) => `Schritte zu spät: ${late} von ${of}`,
  },

  form: {
    required: 'Bitte beantworten Sie diese Frage.',
    open: (many) =>
      many === 1
        ? 'Eine Frage ist noch offen. Sie dürfen sie offen lassen: Drücken Sie noch einmal „Weiter“.'
        : `${many} Fragen sind noch offen. Sie dürfen sie offen lassen: Drücken Sie noch einmal „Weiter“.`,
    missing: (many) =>
      many === 1 ? 'Eine Frage braucht noch eine Antwort.' : `${many} Fragen brauchen noch eine Antwort.`,
    optional: 'freiwillig',
    unset: 'noch nicht beantwortet',
    unsetHint: 'Klicken Sie auf die Linie',
    of: (value, most) => `${value} von ${most}`,
    charsLeft: (left) => `noch ${left} Zeichen`,
    problems: {
      missing: 'Bitte beantworten Sie diese Frage.',
      'wrong-kind': 'Diese Antwort lässt sich nicht lesen. Bitte geben Sie sie noch einmal.',
      'out-of-range': 'Diese Zahl ist hier nicht möglich.',
      'no-choice': 'Bitte wählen Sie eine der Antworten.',
      'too-long': 'Diese Antwort ist zu lang.',
      'no-item': 'Diese Frage wird nicht mehr gestellt.',
    },
    between: (least, most) =>
      least !== null && most !== null
        ? `Eine Zahl von ${least} bis ${most}.`
        : least !== null
          ? `Eine Zahl ab ${least}.`
          : most !== null
            ? `Eine Zahl bis ${most}.`
            : 'Eine Zahl.',
  },

  instructions: {
    pageOf: (page, of) => `Seite ${page} von ${of}`,
    done: 'Ich habe dies gelesen',
    keysLabel: 'Eine Tastatur mit den Tasten, mit denen Sie fliegen',
    try: 'Drücken Sie die Tasten: Sie leuchten auf.',
    pad: 'Ein Gamepad geht auch: linker Stick, Kreuz und untere Taste.',
    change: 'Ändern',
    usual: 'Übliche Tasten',
    press: 'Taste drücken …',
    changeFor: (control) => `Die Taste für „${control}“ ändern`,
    or: 'oder',
    short: control,
    taskLabel: 'Was Sie sehen: was Sie steuern, und die Ziele; Ihres ist bernsteinfarben',
    craft: 'was Sie steuern',
    goal: 'Ihr Ziel, mit ★',
    others: 'andere Ziele, nicht Ihre',
  },

  quiz: {
    title: 'Ist alles klar?',
    text: 'Ein paar Fragen, damit wir wissen, ob wir es gut erklärt haben.',
    check: 'Prüfen',
    wrong: (attempts) =>
      attempts === 1
        ? 'Etwas stimmt noch nicht. Bitte sehen Sie es noch einmal an; Sie haben noch einen Versuch.'
        : `Etwas stimmt noch nicht. Bitte sehen Sie es noch einmal an; Sie haben noch ${attempts} Versuche.`,
  },

  block: {
    practice: (many) => count(many, 'Flug zum Üben', 'Flüge zum Üben'),
    measured: (many) => count(many, 'Flug, der zählt', 'Flüge, die zählen'),
    pause: 'Während eines Flugs hält Esc ihn an.',
  },

  break: {
    title: 'Zeit für eine Pause',
    wait: (seconds) => `In ${clock(seconds)} können Sie weitermachen.`,
    free: 'Machen Sie weiter, wann Sie möchten.',
    late: 'Bitte machen Sie jetzt weiter, wenn Sie können.',
    go: 'Weiter',
  },

  debrief: { title: 'Vielen Dank: das war alles' },

  thanks: {
    title: 'Vielen Dank für Ihre Teilnahme',
    code: 'Ihr Abschlusscode',
    copy: 'Kopieren',
    copied: 'Kopiert',
    back: (seconds) => `In ${count(seconds, 'Sekunde', 'Sekunden')} werden Sie zurückgeleitet.`,
    stay: 'Hier bleiben',
    close: 'Sie können diese Seite jetzt schließen.',
  },

  flightOf: {
    practice: (number, of) => `Übung ${number} von ${of}`,
    measured: (number, of) => `Flug ${number} von ${of}`,
  },

  states: {
    back: 'Zurück zum Anbieter',
    opening: { title: 'Einen Moment', text: 'Die Studie wird geöffnet.' },
    nobody: {
      title: 'Diese Seite braucht Ihren Link',
      text: 'Bitte öffnen Sie den Link, den Sie für diese Studie bekommen haben. Wenn Sie das getan haben, nimmt dieser Browser vielleicht keine Cookies an: Erlauben Sie sie für diese Seite, oder nehmen Sie einen anderen Browser.',
    },
    away: {
      title: 'Keine Verbindung zur Studie',
      text: 'Nichts geht verloren: Was Sie getan haben, ist in diesem Browser aufgehoben. Die Seite versucht es von selbst wieder.',
      again: 'Jetzt versuchen',
    },
    takenOver: {
      title: 'Die Studie läuft in einem anderen Fenster weiter',
      text: 'Sie kann nur in einem Fenster offen sein. Sie können dieses schließen oder hier weitermachen.',
      again: 'Hier weitermachen',
    },
    declined: {
      title: 'Sie nehmen nicht teil',
      text: 'Danke für Ihre Zeit. Von Ihnen wurde nichts aufgezeichnet, außer dass Sie abgelehnt haben. Sie können diese Seite jetzt schließen.',
    },
    withdrawn: {
      title: 'Sie haben sich zurückgezogen',
      text: 'Alles, was in dieser Studie von Ihnen aufgezeichnet war, wurde gelöscht. Danke für Ihre Zeit. Sie können diese Seite jetzt schließen.',
    },
    excluded: {
      title: 'Die Studie endet hier',
      text: 'Danke für Ihre Zeit. Für diese Studie brauchen wir Menschen oder Geräte mit anderen Voraussetzungen; das ist kein Urteil über Sie. Sie können diese Seite jetzt schließen.',
    },
    completed: {
      title: 'Vielen Dank für Ihre Teilnahme',
      text: 'Sie haben die Studie abgeschlossen. Sie können diese Seite jetzt schließen.',
    },
    unable: {
      title: 'Die Seite konnte nicht geöffnet werden',
      text: 'Sie braucht einen Browser von 2022 oder später mit WebAssembly. Versuchen Sie es noch einmal, oder nehmen Sie einen anderen Browser mit demselben Link.',
      again: 'Noch einmal versuchen',
    },
    stuck: {
      title: 'Die Seite kommt nicht weiter',
      text: 'Was Sie bisher getan haben, bleibt erhalten. Laden Sie die Seite neu; wenn sie hier noch einmal stehen bleibt, sagen Sie es bitte der Person, die Sie eingeladen hat.',
      again: 'Seite neu laden',
    },
  },

  flight: {
    canvas: 'Was Sie steuern, und die Ziele; Ihr eigenes ist markiert',
    tilt: 'Neigung',
    away: 'entfernt',
    own: 'IHR ZIEL',
    ready: 'Bereit zum Flug',
    task: 'Kommen Sie an Ihrem Ziel zur Ruhe: dem bernsteinfarbenen mit ★.',
    drag: 'Oder drücken Sie auf das Bild und ziehen Sie: wie mit einem Steuerknüppel unter Maus oder Finger.',
    start: 'Start',
    paused: 'Pause',
    pausedText: 'Alle Tasten sind losgelassen; die Zeit steht still.',
    goOn: 'Weiter',
    interrupted: 'Willkommen zurück',
    interruptedText: 'Ihr Flug wurde unterbrochen. Nach einem Countdown geht er genau dort weiter, wo Sie waren.',
    loading: 'Wird vorbereitet',
    loadingText: 'Der Flug wird vorbereitet.',
    unable: 'Noch nicht bereit',
    again: 'Noch einmal versuchen',
    finished: 'Flug beendet',
    saving: 'Der Flug wird gespeichert …',
    kept: 'Im Moment gibt es keine Verbindung. Ihr Flug ist in diesem Browser aufgehoben und wird gesendet, sobald es wieder eine gibt.',
    refused: 'Dieser Flug konnte nicht gespeichert werden',
    refusedText: 'Das ist nicht Ihre Schuld. Bitte fliegen Sie ihn noch einmal.',
    next: 'Weiter',
    seconds: (seconds) => `${seconds.toFixed(1).replace('.', ',')} s unterwegs`,
    endings: {
      goal: 'Am Ziel',
      elsewhere: 'Woanders',
      crash: 'Verunglückt',
      'out-of-bounds': 'Über die Grenze',
      'time-limit': 'Zeit abgelaufen',
      abandoned: 'Beendet',
    },
    hints: {
      goal: 'In Ruhe, genau dort, wo Sie hinwollten.',
      elsewhere: 'Gut gemacht, aber an einem anderen Ziel als Ihrem.',
      crash: 'Zu hart, oder daneben. Beim nächsten Mal sanfter.',
      'out-of-bounds': 'Dort ist eine Grenze. Bleiben Sie ihr beim nächsten Mal fern.',
      'time-limit': 'Am Ziel muss es ruhen, bevor die Zeit um ist.',
      abandoned: 'Der Flug endet hier.',
    },
    control,
  },
};
